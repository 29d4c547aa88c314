//! Check rows of the batteries: times of hover and of holding.

use super::grip::TriedArm;
use super::hover::Built;
use super::row::{Limit, Row};
use crate::pilot::{CLIMB_MAX, DESCENT_MAX};
use crate::plant::battery::Battery;
use crate::plant::rotor::Rotor;
use crate::plant::servo_power::{MG996R, endurance};
use crate::scenario::{Scenario, Step};

/// Step of the integration, s.
const STEP: f64 = 1.0;
/// Longest computed time, s: three hours.
const LONGEST: f64 = 10_800.0;
const MINUTE: f64 = 60.0;

/// Time of hover until the failsafe lands.
///
/// Value: min until the voltage under the current of four hovering rotors falls to `battery_critical`. Limit: the
/// mission's least time in the air.
pub fn flight(scenario: &Scenario, built: &Built) -> Row {
    let v = &scenario.vehicle;
    let rotor = Rotor::turning(0, f64::from(v.configuration.chi()), v.rotor, built.hover);
    let critical = f64::from(scenario.params.battery_critical);
    let mut battery = Battery::new(v.battery_charge);
    let mut time = 0.0;
    while time < LONGEST {
        battery.step(STEP, 4.0 * rotor.current(battery.voltage()));
        if battery.voltage() <= critical {
            break;
        }
        time += STEP;
    }
    Row::new(
        "flight time",
        time / MINUTE,
        "min",
        Limit::AtLeast(in_the_air(scenario) / MINUTE),
    )
    .advise("charge the battery, fit a larger one, or plan a shorter flight")
}

/// Least time of the pilot's steps in the air, s.
fn in_the_air(scenario: &Scenario) -> f64 {
    let mut height = 0.0;
    let times = scenario.steps.iter().map(|step| match *step {
        Step::TakeOff { height: to } => {
            height = to;
            to / CLIMB_MAX
        }
        Step::Hover { seconds } => seconds,
        Step::FlyTo { height: to, .. } => {
            height = to;
            0.0
        }
        Step::Land => height / DESCENT_MAX,
        _ => 0.0,
    });
    times.sum()
}

/// Time for which the servos' battery holds the grip.
///
/// Value: charge over the closed arms' servo currents at their holding torque, min. Limit: the mission's time on the
/// pipe.
pub fn inspection(scenario: &Scenario, tries: &[TriedArm]) -> Row {
    let current: f64 = tries.iter().map(|arm| MG996R.at(arm.tried.steady)).sum();
    let held: f64 = scenario
        .steps
        .iter()
        .map(|step| match *step {
            Step::Hold { seconds, .. } => seconds,
            _ => 0.0,
        })
        .sum();
    Row::new(
        "inspection time",
        endurance(scenario.vehicle.servo_capacity, current) / MINUTE,
        "min",
        Limit::AtLeast(held / MINUTE),
    )
    .advise("fit softer arms or a larger servo battery, or hold for less time")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hover_time_by_hand_and_none_of_an_empty_battery() {
        let mut s = Scenario::default_mission();
        let row = flight(&s, &Built::of(&s));
        // 192 W and 0.6 A at about 15 V are 13.4 A: 8.1 min for all of 1.8 Ah.
        assert!(row.pass && (7.0..8.2).contains(&row.value), "{row:?}");
        s.vehicle.battery_charge = 0.0;
        assert!(flight(&s, &Built::of(&s)).value.abs() < 1e-9);
    }

    #[test]
    fn the_time_in_the_air_by_hand() {
        let mut s = Scenario::default_mission();
        s.steps = vec![
            Step::TakeOff { height: 7.0 },
            Step::Hover { seconds: 5.0 },
            Step::Land,
        ];
        // 0.7 m/s up and 0.5 m/s down.
        assert!((in_the_air(&s) - 29.0).abs() < 1e-9);
    }
}
