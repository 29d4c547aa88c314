//! Motor, speed controller and propeller.

use sophie_control::allocation::wrench::YAW;

use glam::DVec3;

/// Thrust over squared speed, N·s² (assumed).
pub const THRUST_COEFFICIENT: f64 = 1.5e-5;
/// Reference voltage, V: 4S nominal.
pub const NOMINAL_VOLTAGE: f64 = 14.8;
/// Share of the voltage that drops in the winding at full speed (assumed).
const RESISTIVE_SHARE: f64 = 0.25;
/// Shaft power over electric power in hover (assumed).
const EFFICIENCY: f64 = 0.55;
/// Of propeller and motor bell about their axis, kg·m² (derived, 30 %: 12 g over 0.254 m with 0.6 of a rod's inertia,
/// 30 g of bell at 13 mm).
const SPIN_INERTIA: f64 = 4.5e-5;
/// 2 ρ A of a 10-inch propeller, kg/m: momentum theory's induced power is T^1.5 / √(2 ρ A).
const DISC: f64 = 2.0 * 1.225 * 0.0507;

/// Motor and propeller as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorSpec {
    /// Thrust at full command and nominal voltage, N.
    pub thrust_max: f64,
    /// Drag torque over thrust, m.
    pub torque_ratio: f64,
    /// Time constant of the speed, s.
    pub time_constant: f64,
}

impl Default for RotorSpec {
    fn default() -> Self {
        Self {
            // Assumed from the paper's 450 g nominal and hover at half throttle.
            thrust_max: 8.3,
            // Assumed, 0.002.
            torque_ratio: 0.016,
            // Assumed.
            time_constant: 0.05,
        }
    }
}

impl RotorSpec {
    /// Steady thrust (N) at `command` (0..1) and `voltage` V.
    #[must_use]
    pub fn steady_thrust(&self, command: f64, voltage: f64) -> f64 {
        let share = steady_share(command, voltage);
        self.thrust_max * (share * share)
    }
}

/// Steady speed over full speed, x: u V/V0 = (1 - s) x + s x², since the winding's drop goes with torque.
fn steady_share(command: f64, voltage: f64) -> f64 {
    let drive = command.clamp(0.0, 1.0) * voltage / NOMINAL_VOLTAGE;
    let s = RESISTIVE_SHARE;
    let back = 1.0 - s;
    2.0 * drive / (back + (back * back + 4.0 * s * drive).sqrt())
}

/// One rotor.
#[derive(Clone, Copy, Debug)]
pub struct Rotor {
    spec: RotorSpec,
    /// Speed at full command and nominal voltage, rad/s.
    full_speed: f64,
    /// Sign of the drag moment about body z, against the thrust direction.
    spin: f64,
    speed: f64,
}

impl Rotor {
    /// Rotor `index`, 0 to 3, of configuration B (`chi` +1) or A (-1), stopped.
    #[must_use]
    pub fn new(index: usize, chi: f64, spec: RotorSpec) -> Self {
        Self {
            spec,
            full_speed: (spec.thrust_max / THRUST_COEFFICIENT).sqrt(),
            spin: chi * f64::from(YAW[index]),
            speed: 0.0,
        }
    }

    /// As [`Rotor::new`], turning with `thrust` N.
    #[must_use]
    pub fn turning(index: usize, chi: f64, spec: RotorSpec, thrust: f64) -> Self {
        Self {
            speed: (thrust.max(0.0) / THRUST_COEFFICIENT).sqrt(),
            ..Self::new(index, chi, spec)
        }
    }

    /// Advances by `dt` s under `command` (0..1) at `voltage` V; returns the thrust, N.
    pub fn step(&mut self, dt: f64, command: f64, voltage: f64) -> f64 {
        let target = steady_share(command, voltage) * self.full_speed;
        self.speed += (target - self.speed) * (dt / self.spec.time_constant);
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

    /// Drag moment on the body, N·m, body, with the thrust along `normal`.
    #[must_use]
    pub fn drag_moment(&self, normal: DVec3) -> DVec3 {
        normal * self.drag()
    }

    /// Drag moment on the body about the thrust's direction, N·m.
    #[must_use]
    pub fn drag(&self) -> f64 {
        -self.spin * self.spec.torque_ratio * self.thrust()
    }

    /// Angular momentum along the thrust's direction, N·m·s: positive turns counterclockwise seen from above.
    #[must_use]
    pub fn momentum(&self) -> f64 {
        self.spin * SPIN_INERTIA * self.speed
    }

    /// Battery current at `voltage` V, A.
    #[must_use]
    pub fn current(&self, voltage: f64) -> f64 {
        let t = self.thrust();
        t * (t / DISC).sqrt() / (EFFICIENCY * voltage.max(1.0))
    }
}

#[cfg(test)]
mod tests {
    use super::super::STEP;
    use super::*;

    #[test]
    fn full_command_gives_full_thrust_with_the_stated_lag() {
        let mut r = Rotor::new(0, 1.0, RotorSpec::default());
        let full = (8.3 / THRUST_COEFFICIENT).sqrt();
        for _ in 0..100 {
            r.step(STEP, 1.0, NOMINAL_VOLTAGE);
        }
        assert!((r.speed() / full - 0.632).abs() < 0.01);
        for _ in 0..2000 {
            r.step(STEP, 1.0, NOMINAL_VOLTAGE);
        }
        assert!((r.thrust() - 8.3).abs() < 1e-3);
        assert!((RotorSpec::default().steady_thrust(1.0, NOMINAL_VOLTAGE) - 8.3).abs() < 1e-9);
    }

    #[test]
    fn rotor_1_of_b_turns_the_body_clockwise_from_above() {
        // Clockwise seen from above is positive about z down; the thrust points up.
        let mut r = Rotor::new(0, 1.0, RotorSpec::default());
        for _ in 0..2000 {
            r.step(STEP, 0.5, NOMINAL_VOLTAGE);
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
