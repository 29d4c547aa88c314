//! Vibration of flying rotors, as the stack measures it, and what it costs the attitude.

use std::cell::RefCell;

use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::Configuration;
use sophie_control::vibration::{MARK, Vibration, VibrationMeter};
use sophie_sim::flight::fly_with;
use sophie_sim::flight::stack::Stack;
use sophie_sim::mixers::Variant;
use sophie_sim::record::Silent;
use sophie_sim::scenario::{Scenario, Step};
use sophie_sim::test_stands::flight_level::{Errors, Rig, level, vehicle};

/// The last second's vibration of a hover with rotors of `size` m/s² at 600 rad/s, and its errors.
fn hover(size: f64) -> (Vibration, Errors) {
    let mut scenario = vehicle(Configuration::B, 7.75, 6.9, Variant::Flexible);
    scenario.vehicle.vibration.once = size;
    let mut rig = Rig::calibrated(&scenario, |p| Flexible::new(Configuration::B, p));
    let links = rig.links;
    let meter = RefCell::new((VibrationMeter::new(&links.params), 0, Vibration::default()));
    let errors = rig.fly(20.0, |t| {
        let (meter, seen, last) = &mut *meter.borrow_mut();
        links.raw_forces.take(seen, |force| {
            *last = meter.take(force).unwrap_or(*last);
        });
        level(t)
    });
    (meter.into_inner().2, errors)
}

/// Four rotors, each a sine of another phase: √(4/2) of one's size, which goes with the thrust, 1.5e-5 N s² of it.
#[test]
fn the_measure_is_that_of_four_rotors_and_the_attitude_bears_the_mark() {
    let share = 1.805 * 9.806_65 / 4.0 / 1.5e-5 / (600.0 * 600.0);
    for size in [0.25, 4.0, 6.0, 12.0, 24.0, 48.0] {
        let (found, e) = hover(size);
        println!("{size} m/s2: {found:?}, {e:?}");
        if size > 20.0 {
            continue;
        }
        // As one and the same sine they would give twice as much, against each other nothing.
        let rms = size * share * 2f64.sqrt();
        let [x, y, z] = found.rms.to_array().map(f64::from);
        assert!((0.5..1.5).contains(&(x / rms)), "{found:?}, {rms}");
        assert!(
            (y / x - 0.7).abs() < 0.05 && (z / x - 1.0).abs() < 0.05,
            "{found:?}"
        );
        assert_eq!(found.clipped, 0);
        if found.worst() <= MARK {
            assert!(e.worst_pitch < 1.0 && e.rms_roll < 0.5, "{e:?}");
        }
    }
}

/// The warning when the flight has ended, at `size` m/s² of each rotor.
fn warning(size: f64) -> &'static str {
    let mut scenario = Scenario::default_mission();
    scenario.steps = [
        Step::Arm,
        Step::TakeOff { height: 2.0 },
        Step::Hover { seconds: 5.0 },
        Step::Land,
        Step::Disarm,
    ]
    .to_vec();
    scenario.vehicle.vibration.once = size;
    let (record, stack) = fly_with(&scenario, || Stack::new(&scenario), &mut Silent);
    assert!(record.outcome.accomplished, "{:?}", record.outcome);
    println!("{size}: {:?}", stack.links.vibration.latest());
    stack.links.status.fresh().unwrap().warning
}

#[test]
fn a_vehicle_that_vibrates_says_so_after_landing() {
    assert_eq!(warning(4.0), "");
    assert_eq!(warning(9.0), "vibration: balance the propellers");
}
