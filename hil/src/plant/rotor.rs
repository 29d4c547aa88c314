//! Motor, speed controller and propeller.

use sophie_control::wrench::YAW;

use glam::DVec3;

/// Thrust over the square of the speed, N·s² (assumed).
pub const THRUST_COEFFICIENT: f64 = 1.5e-5;
/// Drag torque over thrust, m (assumed, 0.002).
pub const TORQUE_RATIO: f64 = 0.016;
/// Thrust of full command at the nominal voltage, N.
pub const THRUST_MAX: f64 = 8.3;
/// Voltage to which it belongs, V: 4S nominal.
pub const NOMINAL_VOLTAGE: f64 = 14.8;
/// Time constant of the speed, s (assumed).
const TIME_CONSTANT: f64 = 0.05;
/// Share of the voltage that the winding takes at full speed (assumed).
const RESISTIVE_SHARE: f64 = 0.25;
/// Shaft power of hover over electric power (assumed).
const EFFICIENCY: f64 = 0.55;
/// 2 ρ A of a 10-inch propeller, kg/m: momentum theory's induced power is T^1.5 / √(2 ρ A).
const DISC: f64 = 2.0 * 1.225 * 0.0507;

/// One rotor.
#[derive(Clone, Copy, Debug)]
pub struct Rotor {
    /// Sense of the drag moment against the thrust direction: its sign about body z.
    spin: f64,
    speed: f64,
}

impl Rotor {
    /// Rotor `index`, 0 to 3, of configuration B (`chi` +1) or A (-1), at a stop.
    #[must_use]
    pub fn new(index: usize, chi: f64) -> Self {
        Self {
            spin: chi * f64::from(YAW[index]),
            speed: 0.0,
        }
    }

    /// Advances by `dt` s under the command `command` (0..1) at `voltage` V; returns the thrust, N.
    pub fn step(&mut self, dt: f64, command: f64, voltage: f64) -> f64 {
        // Steady speed x of full speed: u V/V0 = (1 - s) x + s x², the winding's drop with the torque's square.
        let drive = command.clamp(0.0, 1.0) * voltage / NOMINAL_VOLTAGE;
        let s = RESISTIVE_SHARE;
        let back = 1.0 - s;
        let steady = 2.0 * drive / (back + (back * back + 4.0 * s * drive).sqrt());
        let target = steady * (THRUST_MAX / THRUST_COEFFICIENT).sqrt();
        self.speed += (target - self.speed) * (dt / TIME_CONSTANT);
        self.thrust()
    }

    /// Thrust, N.
    #[must_use]
    pub fn thrust(&self) -> f64 {
        THRUST_COEFFICIENT * self.speed * self.speed
    }

    /// Speed, rad/s.
    #[must_use]
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// Moment of the drag on the body, N·m, body, with the thrust along `normal`.
    #[must_use]
    pub fn drag_moment(&self, normal: DVec3) -> DVec3 {
        normal * (-self.spin * TORQUE_RATIO * self.thrust())
    }

    /// Current from the battery at `voltage` V, A.
    #[must_use]
    pub fn current(&self, voltage: f64) -> f64 {
        let t = self.thrust();
        t * (t / DISC).sqrt() / (EFFICIENCY * voltage.max(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn full_command_gives_full_thrust_with_the_stated_lag() {
        let mut r = Rotor::new(0, 1.0);
        let full = (THRUST_MAX / THRUST_COEFFICIENT).sqrt();
        for _ in 0..200 {
            r.step(0.25e-3, 1.0, NOMINAL_VOLTAGE);
        }
        assert!((r.speed() / full - 0.632).abs() < 0.01);
        for _ in 0..4000 {
            r.step(0.25e-3, 1.0, NOMINAL_VOLTAGE);
        }
        assert!((r.thrust() - THRUST_MAX).abs() < 1e-3);
    }

    #[test]
    fn rotor_1_of_b_turns_the_body_clockwise_from_above() {
        // Clockwise seen from above is positive about z down; the thrust points up.
        let mut r = Rotor::new(0, 1.0);
        for _ in 0..4000 {
            r.step(0.25e-3, 0.5, NOMINAL_VOLTAGE);
        }
        assert!(r.drag_moment(DVec3::new(0.0, 0.0, -1.0)).z > 0.0);
        assert!(
            Rotor { spin: -1.0, ..r }
                .drag_moment(DVec3::new(0.0, 0.0, -1.0))
                .z
                < 0.0
        );
    }
}
