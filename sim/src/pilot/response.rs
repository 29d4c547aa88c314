//! How the vehicle follows the sticks, as the pilot has learned it on earlier flights.

use sophie_control::attitude::gains::Gains;

use crate::scenario::Scenario;

/// Lag of the lean and of the thrust behind the sticks, s, of the default loops and usual motors.
const LEAN_TIME: f64 = 0.35;
const THRUST_TIME: f64 = 0.08;
/// Lag of these motors, s.
const MOTOR_TIME: f32 = 0.05;

/// The vehicle's response to the sticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StickResponse {
    /// Lag of the lean, s.
    pub lean_time: f64,
    /// Lag of the thrust, s.
    pub thrust_time: f64,
}

impl StickResponse {
    /// The response of the scenario's vehicle: its true motors, and the loops that fly it.
    pub fn of(scenario: &Scenario) -> Self {
        let pace = f64::from(Gains::of(&scenario.params).pace);
        let beyond = |lag: f32| f64::from(scenario.vehicle.rotor.spin.up as f32 - lag);
        Self {
            lean_time: LEAN_TIME / pace + beyond(scenario.params.motor_tau),
            thrust_time: THRUST_TIME + beyond(MOTOR_TIME),
        }
    }

    /// Pace of the lean over that of the default loops.
    pub fn pace(&self) -> f64 {
        LEAN_TIME / self.lean_time
    }

    /// Lag of the thrust beyond that of the usual motors, s.
    pub fn thrust_beyond(&self) -> f64 {
        self.thrust_time - THRUST_TIME
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn response(told: f32, lag: f64) -> StickResponse {
        let mut scenario = Scenario::default_mission();
        scenario.params.motor_tau = told;
        scenario.vehicle.rotor.spin.up = lag;
        StickResponse::of(&scenario)
    }

    #[test]
    fn the_usual_vehicle_is_what_the_gains_are_meant_for() {
        let found = response(0.05, 0.05);
        assert!(found.pace() == 1.0 && found.thrust_beyond() == 0.0, "{found:?}");
    }

    #[test]
    fn slower_motors_are_felt_known_or_not() {
        assert!(response(0.3, 0.3).pace() < 0.6);
        let untold = response(0.05, 0.09);
        assert!((untold.lean_time - 0.39).abs() < 1e-6, "{untold:?}");
        assert!((untold.thrust_beyond() - 0.04).abs() < 1e-6, "{untold:?}");
    }
}
