//! Motors that are slower than the default ones, known or not, and what a hold makes of a swing.

use sophie_sim::check::Check;

use super::*;

/// A hold of a vehicle with motors of `lag` s that is told `told` s.
fn slow(seed: u64, seconds: f64, lag: f64, told: f32) -> Scenario {
    let mut s = held(seed, seconds);
    s.vehicle.rotor.spin.up = lag;
    s.params.motor_tau = told;
    s
}

/// Time at which the display first says that it swings, s.
fn swung_at(record: &FlightRecord) -> Option<f64> {
    let said = |text: &str| text.ends_with(Reason::Swings.text());
    record.events.iter().find(|e| said(&e.text)).map(|e| e.t)
}

/// Largest RMS of the roll and pitch rates, deg/s.
fn rates(samples: &[&Sample]) -> f64 {
    let rms = |axis: usize| {
        let squares = samples.iter().map(|s| s.rate[axis] * s.rate[axis]);
        (squares.sum::<f64>() / samples.len() as f64).sqrt().to_degrees()
    };
    rms(0).max(rms(1))
}

#[test]
fn slow_motors_that_are_known_are_held_as_the_others() {
    for lag in [0.03, 0.08, 0.12] {
        let record = fly(&slow(3, 40.0, lag, lag as f32), &mut Silent);
        let [level, ..] = errors(&settled(&record));
        assert!(level < LEVEL_RMS, "{lag}: {level}");
        assert_eq!(swung_at(&record), None, "{lag}");
    }
}

#[test]
fn motors_that_are_slower_than_told_swing_and_are_held_gently() {
    let mut sum = 0.0;
    for seed in 1..=10 {
        let record = fly(&slow(seed, 60.0, 0.10, 0.05), &mut Silent);
        let noticed = swung_at(&record).unwrap();
        let within = |from: f64, to: f64| -> Vec<&Sample> {
            let times = noticed + from..noticed + to;
            record.samples.iter().filter(|s| times.contains(&s.t)).collect()
        };
        assert!(record.outcome.accomplished, "{seed}: {}", record.outcome.reason);
        // Four seconds after it was noticed what gusts make is left.
        let (before, after) = (rates(&within(-3.0, 0.0)), rates(&within(4.0, 24.0)));
        assert!(after < 0.15 * before, "{seed}: {before} {after}");
        sum += after;
    }
    assert!(sum / 10.0 < 10.0, "{} deg/s in the mean", sum / 10.0);
}

/// What the false alarms of the watch rest on: about 8 deg/s.
#[test]
fn gusts_of_a_strong_wind_are_no_swing() {
    for seed in [5, 6] {
        let mut s = held(seed, 60.0);
        (s.world.gust_force, s.world.gust_moment, s.world.steady_wind) = (0.0, 0.0, 0.0);
        (s.world.air.wind.speed, s.world.air.wind.gust) = (6.0, 1.2);
        let record = fly(&s, &mut Silent);
        assert_eq!(swung_at(&record), None, "{seed}");
        let found = rates(&settled(&record));
        println!("{seed}: {found:.1} deg/s");
        assert!(found > 1.0 && found < 9.0, "{seed}: {found}");
    }
}

/// The design check refuses what swings, and lets pass what does not.
#[test]
fn arms_that_twist_too_much_swing_as_the_design_check_says() {
    for (torsion, swings) in [(0.5, true), (1.0, false)] {
        let mut s = slow(4, 40.0, 0.05, 0.05);
        s.vehicle.arm_torsion = torsion;
        let margin = Check::of(&s)
            .rows
            .into_iter()
            .find(|row| row.name == "hold gain margin");
        assert_eq!(margin.map(|row| row.pass), Some(!swings), "{torsion}");
        let record = fly(&s, &mut Silent);
        assert_eq!(swung_at(&record).is_some(), swings, "{torsion}");
    }
}
