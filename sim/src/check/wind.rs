//! Check row of the wind.

use glam::DVec3;

use super::hover::Built;
use super::row::{Limit, Row};
use super::thrust::GUST_FACTOR;
use crate::plant::GRAVITY;
use crate::scenario::Scenario;

/// Steady wind force against which the vehicle keeps place and height.
///
/// Value: W tan θ, N, θ the largest lean with L cos θ >= W within the stick's limit. Limit: the scenario's steady wind, and
/// three times the RMS of the gusts' horizontal force on both axes. A wind given as a velocity pushes with the drag of
/// the vehicle in hover, its gusts likewise.
pub fn row(scenario: &Scenario, built: &Built) -> Row {
    let lift = built.lift(scenario.vehicle.rotor.thrust_max);
    let upright = libm::acos((built.weight / lift).clamp(0.0, 1.0));
    let lean = upright.min(f64::from(scenario.params.stick_angle));
    let force = if lean.is_finite() {
        built.weight * libm::tan(lean)
    } else {
        0.0
    };
    let gusts = GUST_FACTOR * scenario.world.gust_force * std::f64::consts::SQRT_2;
    let needed = scenario.world.steady_wind + gusts + of_air(scenario);
    Row::new("wind force", force, "N", Limit::AtLeast(needed))
        .advise("raise stick_angle, make it lighter, or wait for less wind")
}

/// Force of the scenario's wind and of three times the RMS of its gusts on a vehicle whose rotors stand still, N.
pub(crate) fn on_pipe(scenario: &Scenario) -> f64 {
    let (world, drag) = (&scenario.world, scenario.vehicle.air.drag);
    let gusts = GUST_FACTOR * std::f64::consts::SQRT_2;
    let speed = world.air.wind.speed + gusts * world.air.wind.gust;
    world.steady_wind + gusts * world.gust_force + drag.on_body(DVec3::X * speed, world.air.density).length()
}

/// Drag in the scenario's wind and three times the RMS of its gusts on both axes, N.
fn of_air(scenario: &Scenario) -> f64 {
    let (drag, air) = (scenario.vehicle.air.drag, scenario.world.air);
    let speed = air.wind.speed + GUST_FACTOR * air.wind.gust * std::f64::consts::SQRT_2;
    let thrust = scenario.vehicle.body.mass * GRAVITY;
    let rotors = if drag.on_rotors { drag.linear * speed } else { 0.0 };
    let body = drag.on_body(DVec3::X * speed, air.density).length();
    body + rotors + drag.flapping * speed * thrust
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.3 · 6 + ½ · 1.225 · 0.04 · 36 N of steady wind.
    #[test]
    fn a_wind_as_a_velocity_asks_for_its_drag() {
        let mut s = Scenario::default_mission();
        let still = of_air(&s);
        s.world.air.wind.speed = 6.0;
        s.vehicle.air.drag.area = 0.04;
        for on_rotors in [false, true] {
            s.vehicle.air.drag.on_rotors = on_rotors;
            assert!((of_air(&s) - (1.8 + 0.882)).abs() < 1e-9);
        }
        assert_eq!(still, 0.0);
    }

    #[test]
    fn the_stick_limits_the_lean_of_a_strong_vehicle_and_the_lift_that_of_a_weak_one() {
        let mut s = Scenario::default_mission();
        // 17.70 N · tan 0.61 rad.
        let strong = row(&s, &Built::of(&s)).value;
        assert!((strong - 17.70 * libm::tan(0.61_f64)).abs() < 0.05, "{strong}");
        s.vehicle.body.mass = 3.0;
        let built = Built::of(&s);
        let weak = row(&s, &built).value;
        let lift = built.lift(8.3);
        assert!(
            (weak - (lift * lift - built.weight * built.weight).sqrt()).abs() < 0.05,
            "{weak}"
        );
        s.vehicle.rotor.thrust_max = 5.0;
        assert!(row(&s, &Built::of(&s)).value.abs() < 1e-9);
    }
}
