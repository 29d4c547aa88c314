//! Watches that the pressure rises with the tension, until a sensor has shown that it can read the grip pressure.
//!
//! Behind a divider that no parameter states, a sensor's reading ends far below the grip pressure, however hard the arm
//! presses: the loop would wind to the force limit. A pressure that rises so slowly that the whole limit would not bring
//! it to the grip pressure never gets there, so no arm that could have held is stopped.

use super::Config;
use crate::filter::LowPass;

/// Rise of the tension (N) over which the pressure is expected to rise: the whole way from touch to grip on a skin of
/// 70 Pa/N, and more than an arm that is still swinging feels.
const WINDOW: f32 = 12.0;
/// Cut-off of the tension, rad/s: one tilt that is 0.1 rad wrong is 20 N for a frame.
const CUTOFF: f32 = 20.0;

/// The watch of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CeilingWatch {
    tension: Option<LowPass>,
    from: Option<Start>,
    /// The grip pressure has been read since the arm closed: the sensor has the range.
    shown: bool,
}

/// Where a window began, N and Pa.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Start {
    tension: f32,
    force: f32,
    pressure: f32,
}

impl CeilingWatch {
    /// Begins anew after a time without control of the pressure.
    pub fn pause(&mut self) {
        (self.tension, self.from) = (None, None);
    }

    /// Takes note of the pressure of an arm that touches (Pa), and of its tension and the force asked for without what
    /// meets the rotor's thrust (N). True when both rose by the window and the pressure did not follow.
    pub fn step(&mut self, cfg: &Config, pressure: f32, tension: f32, force: f32, dt: f32) -> bool {
        self.shown |= pressure >= cfg.demand.pressure - cfg.demand.tolerance;
        if self.shown {
            return false;
        }
        let tension = self
            .tension
            .get_or_insert(LowPass::at(tension))
            .step(tension, CUTOFF, dt);
        let now = Start {
            tension,
            force,
            pressure,
        };
        let from = self.from.get_or_insert(now);
        let (pulled, asked) = (tension - from.tension, force - from.force);
        if pulled < 0.0 || asked < 0.0 {
            *from = now;
        }
        // A push raises the tension alone, an arm at the end of its servo the force alone.
        let rise = if pulled < asked { pulled } else { asked };
        if rise < WINDOW {
            return false;
        }
        let risen = pressure - from.pressure;
        *from = now;
        risen < rise * cfg.demand.pressure / cfg.limit
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::params::Params;

    const DT: f32 = 0.01;

    /// Steps for 2 s in which pressure (from 300 Pa), tension and force (from 50 N) rise by so much; true for a ceiling.
    fn seen(watch: &mut CeilingWatch, pressure: f32, tension: f32, force: f32) -> bool {
        let cfg = Config::from_params(&Params::default());
        (0..=200).any(|step| {
            let share = step as f32 / 200.0;
            let (pressure, tension, force) = (
                300.0 + share * pressure,
                50.0 + share * tension,
                50.0 + share * force,
            );
            watch.step(&cfg, pressure, tension, force, DT)
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
            // 20 N too much for a frame of 20 ms, where both have risen by 5 N.
            let wrong = if (100..102).contains(&step) { 20.0 } else { 0.0 };
            let base = if step > 50 { 55.0 } else { 50.0 };
            assert!(
                !watch.step(
                    &cfg,
                    300.0,
                    base + wrong,
                    base + 20.0 * f32::from(u8::from(step > 90)),
                    DT
                ),
                "{step}"
            );
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
}
