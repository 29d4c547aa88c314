//! Speed of motor and propeller under their controller.
//!
//! The controller drives the speed towards a target with a time constant, up and down apart. One that does not brake
//! leaves slowing to the air: I ω̇ ≥ -Q, Q the propeller's drag torque. Full regenerative braking ("damped light") is the
//! default of BLHeli; older controllers on pulses coast.

use super::SPIN_INERTIA;

/// Change of the speed, as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpinSpec {
    /// Time constant while it gains speed, s.
    pub up: f64,
    /// Time constant while it loses speed, s; `None`: as up.
    pub down: Option<f64>,
    /// The controller brakes the motor.
    pub brakes: bool,
}

impl SpinSpec {
    /// Change of `speed` (rad/s) in `dt` s towards `target` (rad/s), against the drag torque `drag` (N·m), rad/s.
    #[must_use]
    pub fn change(&self, dt: f64, speed: f64, target: f64, drag: f64) -> f64 {
        let missing = target - speed;
        let time = if missing < 0.0 {
            self.down.unwrap_or(self.up)
        } else {
            self.up
        };
        let change = missing * (dt / time);
        if self.brakes {
            change
        } else {
            change.max(-drag / SPIN_INERTIA * dt)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const COAST: SpinSpec = SpinSpec {
        up: 0.05,
        down: None,
        brakes: false,
    };

    /// k_q T / I with T 4.43 N: 1,575 rad/s², 25.7 N/s of thrust by dT = 2 √(k T) dω.
    #[test]
    fn a_controller_that_does_not_brake_leaves_slowing_to_the_air() {
        let (thrust, dt): (f64, f64) = (4.43, 0.5e-3);
        let speed = (thrust / super::super::THRUST_COEFFICIENT).sqrt();
        let change = COAST.change(dt, speed, 0.0, 0.016 * thrust) / dt;
        assert!((change + 1575.1).abs() < 0.1, "{change}");
        let fall = 2.0 * (super::super::THRUST_COEFFICIENT * thrust).sqrt() * change;
        assert!((fall + 25.7).abs() < 0.1, "{fall}");
        let braked = SpinSpec {
            brakes: true,
            ..COAST
        };
        assert!((braked.change(dt, speed, 0.0, 0.016 * thrust) / dt + speed / 0.05).abs() < 1e-9);
        // Near the target, and upwards, both are alike.
        for target in [speed - 1.0, speed + 100.0] {
            let by = |spec: SpinSpec| spec.change(dt, speed, target, 0.016 * thrust);
            assert_eq!(by(COAST), by(braked));
        }
    }

    #[test]
    fn up_and_down_have_their_own_times() {
        let spec = SpinSpec {
            up: 0.05,
            down: Some(0.17),
            brakes: true,
        };
        assert!((spec.change(0.001, 500.0, 600.0, 0.0) - 2.0).abs() < 1e-12);
        assert!((spec.change(0.001, 600.0, 500.0, 0.0) + 100.0 * 0.001 / 0.17).abs() < 1e-12);
    }
}
