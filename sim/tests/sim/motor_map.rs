//! Motors wired in another order than the rotors, flown with the matching map and without it.

use sophie_control::allocation::wrench::Configuration;
use sophie_control::params::{MotorMap, Params};
use sophie_sim::mixers::Variant;
use sophie_sim::test_stands::flight_level::{Errors, Rig, level, vehicle};

/// Outputs 1 and 2 changed places, and 3 and 4.
fn wired() -> MotorMap {
    MotorMap::of([1, 0, 3, 2]).unwrap()
}

fn hover(motor_map: MotorMap) -> Errors {
    let mut scenario = vehicle(Configuration::default(), 7.75, 6.9, Variant::Flexible);
    scenario.params = Params {
        motor_map,
        ..scenario.params
    };
    Rig::wired(&scenario, wired()).fly(12.0, level)
}

#[test]
fn a_vehicle_hovers_by_the_map_of_its_wires_and_turns_over_without_it() {
    let mapped = hover(wired());
    assert!(mapped.worst_roll < 3.0 && mapped.worst_pitch < 3.0, "{mapped:?}");
    let straight = hover(MotorMap::STRAIGHT);
    assert!(
        straight.worst_roll.max(straight.worst_pitch) > 45.0,
        "{straight:?}"
    );
}
