//! Pushes on a copy of the vehicle as it hangs, from any side, with its servos where they are.
//!
//! Independent of sensors and estimates: the copy is pushed at its centre of mass by a force that rises within 0.3 s and
//! stays for as long again, along eight horizontal directions and upwards. It holds if it moves by less than the slip that
//! the mission allows.

use core::f64::consts::FRAC_PI_4;

use glam::DVec3;

use crate::plant::{Actuators, Plant, STEP};

/// Time in which the push rises, and for which it then stays, s.
const RISE: f64 = 0.3;
/// Names of the directions of a push, clockwise from north.
const TOWARDS: [&str; 8] = [
    "north",
    "north-east",
    "east",
    "south-east",
    "south",
    "south-west",
    "west",
    "north-west",
];

/// A push that the grip did not hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Slipped {
    /// Direction, such as `east` or `up`.
    pub towards: &'static str,
    /// Way of the body's origin, m.
    pub way: f64,
}

/// Pushes copies of `plant` with `force` N; the first direction in which it moves by more than `slip` m.
#[must_use]
pub fn slips(plant: &Plant, force: f64, slip: f64) -> Option<Slipped> {
    let level = TOWARDS.iter().enumerate().map(|(index, towards)| {
        let (sin, cos) = libm::sincos(index as f64 * FRAC_PI_4);
        (*towards, DVec3::new(cos, sin, 0.0))
    });
    level
        .chain([("up", DVec3::NEG_Z)])
        .find_map(|(towards, direction)| {
            let way = pushed(plant.clone(), direction * force, slip);
            (way > slip).then_some(Slipped { towards, way })
        })
}

/// Largest way of `plant` under `force` (N, NED), m, up to a little over `enough`.
fn pushed(mut plant: Plant, force: DVec3, enough: f64) -> f64 {
    let start = plant.pose().position;
    let actuators = Actuators {
        motors: [0.0; 4],
        ..plant.actuators()
    };
    let mut way: f64 = 0.0;
    for step in 0..(2.0 * RISE / STEP) as u32 {
        plant.push = force * (f64::from(step) * STEP / RISE).min(1.0);
        plant.step(&actuators);
        way = way.max((plant.pose().position - start).length());
        if way > enough {
            break;
        }
    }
    way
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::Scenario;

    /// On the ground, friction 0.7 of 17.7 N holds a push of 6 N from any side and not one of 16 N; up it takes the weight.
    #[test]
    fn a_vehicle_on_the_ground_holds_up_to_its_friction() {
        let mut plant = Scenario::default_mission().plant();
        for _ in 0..4000 {
            plant.step(&Actuators::default());
        }
        assert_eq!(slips(&plant, 6.0, 0.03), None);
        let slipped = slips(&plant, 16.0, 0.03).unwrap();
        assert_eq!(slipped.towards, "north");
        assert!((0.03..0.05).contains(&slipped.way), "{slipped:?}");
    }
}
