//! Motor, speed controller and propeller.

pub mod delay;
pub mod heat;
pub mod spin;

use sophie_control::allocation::wrench::YAW;

use glam::DVec3;

use self::delay::Delay;
use self::heat::Heat;
use self::spin::SpinSpec;

/// Thrust over squared speed in the standard's air, N·s² (assumed; 1.53e-5 of an APC SF 10x4.7, UIUC propeller data).
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
/// Density of the standard's air at sea level and 15 °C, kg/m³.
pub const STANDARD_DENSITY: f64 = 1.225;
/// 2 ρ A of a 10-inch propeller, kg/m: momentum theory's induced power is T^1.5 / √(2 ρ A).
const DISC: f64 = 2.0 * 1.225 * 0.0507;

/// Motor and propeller as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotorSpec {
    /// Thrust at full command and nominal voltage in the standard's air, N.
    pub thrust_max: f64,
    /// Drag torque over static thrust, m.
    pub torque_ratio: f64,
    /// Lag of the speed.
    pub spin: SpinSpec,
    /// Delay of the controller, s.
    pub delay: f64,
    /// Power of the voltage that the thrust at a command goes with; `None`: by the winding's drop, 1.67 in hover.
    pub voltage_power: Option<f64>,
    /// The rotor's change of speed turns the body.
    pub reaction: bool,
    /// Share of thrust that a motor loses in long hover.
    pub heat_fade: f64,
}

impl Default for RotorSpec {
    fn default() -> Self {
        Self {
            // Assumed from the paper's 450 g nominal and hover at half throttle.
            thrust_max: 8.3,
            // Assumed, 0.002.
            torque_ratio: 0.016,
            spin: SpinSpec {
                // Assumed.
                up: 0.05,
                down: None,
                brakes: true,
            },
            delay: 0.0,
            voltage_power: None,
            reaction: false,
            heat_fade: 0.0,
        }
    }
}

impl RotorSpec {
    /// Steady thrust (N) at `command` (0..1) and `voltage` V.
    #[must_use]
    pub fn steady_thrust(&self, command: f64, voltage: f64) -> f64 {
        let share = self.steady_share(command, voltage, 1.0);
        self.thrust_max * (share * share)
    }

    /// Thrust at full command and nominal voltage in air of `density` kg/m³ over that in the standard's: thin air unloads the
    /// rotor, which then turns faster.
    #[must_use]
    pub fn air_ratio(&self, density: f64) -> f64 {
        let density = density / STANDARD_DENSITY;
        let share = self.steady_share(1.0, NOMINAL_VOLTAGE, density);
        density * share * share
    }

    /// Steady speed over full speed at `command` (0..1), `voltage` V and `density` over the standard's.
    fn steady_share(&self, command: f64, voltage: f64, density: f64) -> f64 {
        match self.voltage_power {
            None => steady_share(command, voltage, density),
            Some(power) => {
                let nominal = steady_share(command, NOMINAL_VOLTAGE, density);
                nominal * libm::pow(voltage.max(0.0) / NOMINAL_VOLTAGE, 0.5 * power)
            }
        }
    }
}

/// Steady speed over full speed, x: u V/V0 = (1 - s) x + s ρ/ρ0 x², since the winding's drop goes with torque.
fn steady_share(command: f64, voltage: f64, density: f64) -> f64 {
    let drive = command.clamp(0.0, 1.0) * voltage / NOMINAL_VOLTAGE;
    let s = RESISTIVE_SHARE * density;
    let back = 1.0 - RESISTIVE_SHARE;
    2.0 * drive / (back + (back * back + 4.0 * s * drive).sqrt())
}

/// One rotor.
#[derive(Clone, Copy, Debug)]
pub struct Rotor {
    spec: RotorSpec,
    /// Speed at full command and nominal voltage, rad/s.
    full_speed: f64,
    /// Thrust over squared speed in today's air, N·s².
    coefficient: f64,
    /// Density over the standard's.
    density: f64,
    /// Sign of the drag moment about body z, against the thrust direction.
    spin: f64,
    speed: f64,
    /// Change of the speed in the last step, rad/s².
    acceleration: f64,
    delay: Delay,
    heat: Heat,
}

impl Rotor {
    /// Rotor `index`, 0 to 3, of configuration B (`chi` +1) or A (-1), stopped.
    #[must_use]
    pub fn new(index: usize, chi: f64, spec: RotorSpec) -> Self {
        Self {
            spec,
            full_speed: (spec.thrust_max / THRUST_COEFFICIENT).sqrt(),
            coefficient: THRUST_COEFFICIENT,
            density: 1.0,
            spin: chi * f64::from(YAW[index]),
            speed: 0.0,
            acceleration: 0.0,
            delay: Delay::new(spec.delay),
            heat: Heat::new(spec.heat_fade),
        }
    }

    /// The same with `factor` times the thrust of its kind at a speed, in air of `density` kg/m³.
    #[must_use]
    pub fn in_air(self, factor: f64, density: f64) -> Self {
        let density = density / STANDARD_DENSITY;
        Self {
            coefficient: THRUST_COEFFICIENT * (factor * density),
            density,
            ..self
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
        let command = self.delay.pass(command);
        let target = self.spec.steady_share(command, voltage, self.density) * self.full_speed;
        let drag = self.spec.torque_ratio * self.thrust();
        let change = self.spec.spin.change(dt, self.speed, target, drag);
        self.speed += change;
        self.acceleration = change / dt;
        let thrust = self.thrust();
        self.heat.step(dt, thrust / (0.5 * self.spec.thrust_max));
        thrust
    }

    /// Static thrust, N: in air that only the rotor moves.
    #[must_use]
    pub fn thrust(&self) -> f64 {
        self.coefficient * self.speed * self.speed * self.heat.factor()
    }

    /// Speed at full command and nominal voltage, rad/s.
    #[must_use]
    pub fn full_speed(&self) -> f64 {
        self.full_speed
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

    /// Moment of drag, and of the rotor's change of speed, on the body about the thrust's direction, N·m.
    #[must_use]
    pub fn drag(&self) -> f64 {
        let aerodynamic = -self.spin * self.spec.torque_ratio * self.thrust();
        if self.spec.reaction {
            // The motor's torque is what turns the air and what turns the rotor.
            aerodynamic - self.spin * SPIN_INERTIA * self.acceleration
        } else {
            aerodynamic
        }
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
    fn thin_air_takes_less_thrust_than_its_density() {
        let spec = RotorSpec::default();
        assert_eq!(spec.air_ratio(STANDARD_DENSITY), 1.0);
        // u = (1 - s) x + s ρ x² at ρ 0.9 of the standard's: x = 2 / (0.75 + √(0.5625 + 0.9)).
        let ratio = spec.air_ratio(0.9 * STANDARD_DENSITY);
        assert!((ratio - 0.9 * 1.020_75 * 1.020_75).abs() < 1e-4, "{ratio}");
        let mut rotor = Rotor::new(0, 1.0, spec).in_air(1.0, 0.9 * STANDARD_DENSITY);
        for _ in 0..2000 {
            rotor.step(STEP, 1.0, NOMINAL_VOLTAGE);
        }
        assert!((rotor.thrust() / (8.3 * ratio) - 1.0).abs() < 1e-4);
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
