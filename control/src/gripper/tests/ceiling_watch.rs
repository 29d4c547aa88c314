//! The ceiling watch alone.

use super::DT;
use crate::gripper::Config;
use crate::gripper::ceiling_watch::{CeilingSample, CeilingWatch};
use crate::params::Params;

/// Raises pressure (from 300 Pa), tension and force (from 50 N) by this much in 2 s; true for a ceiling.
fn seen(watch: &mut CeilingWatch, pressure: f32, tension: f32, force: f32) -> bool {
    let cfg = Config::from_params(&Params::default());
    (0..=200).any(|step| {
        let share = step as f32 / 200.0;
        let sample = CeilingSample {
            pressure: 300.0 + share * pressure,
            tension: 50.0 + share * tension,
            force: 50.0 + share * force,
        };
        watch.step(&cfg, sample, DT)
    })
}

#[test]
fn a_pressure_that_could_not_arrive_within_the_limit_is_a_ceiling() {
    // 950 Pa over the limit of 160.3 N (2.452 N m at 15 mm, less 2 % for the tilt's error) are 5.9 Pa/N.
    let limit = Config::from_params(&Params::default()).limit;
    assert!((155.0..164.0).contains(&limit), "{limit}");
    for (rise, ceiling) in [(0.0, true), (100.0, true), (140.0, false), (560.0, false)] {
        assert_eq!(
            seen(&mut CeilingWatch::default(), rise, 20.0, 20.0),
            ceiling,
            "{rise}"
        );
    }
}

#[test]
fn only_tension_and_force_together_wind() {
    let cases = [
        (20.0, 20.0, true),
        (40.0, 0.0, false),
        (0.0, 40.0, false),
        (11.0, 11.0, false),
        (-40.0, -40.0, false),
    ];
    for (tension, force, ceiling) in cases {
        let mut watch = CeilingWatch::default();
        assert_eq!(
            seen(&mut watch, 0.0, tension, force),
            ceiling,
            "{tension} {force}"
        );
    }
}

#[test]
fn one_wrong_tilt_does_not_wind() {
    let cfg = Config::from_params(&Params::default());
    let mut watch = CeilingWatch::default();
    for step in 0..200 {
        // 20 N too much for a frame of 20 ms, after a rise of both by 5 N.
        let wrong = if (100..102).contains(&step) { 20.0 } else { 0.0 };
        let base = if step > 50 { 55.0 } else { 50.0 };
        let sample = CeilingSample {
            pressure: 300.0,
            tension: base + wrong,
            force: base + 20.0 * f32::from(u8::from(step > 90)),
        };
        assert!(!watch.step(&cfg, sample, DT), "{step}");
    }
}

#[test]
fn what_has_read_the_grip_pressure_is_not_watched_again_nor_across_a_pause() {
    let mut watch = CeilingWatch::default();
    assert!(!seen(&mut watch, 610.0, 10.0, 10.0));
    assert!(!seen(&mut watch, 0.0, 40.0, 40.0));
    let mut watch = CeilingWatch::default();
    for _ in 0..5 {
        assert!(!seen(&mut watch, 0.0, 10.0, 10.0));
        watch.pause();
    }
}
