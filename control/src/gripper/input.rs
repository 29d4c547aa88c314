//! What comes in for one arm, and what of it is usable.

use crate::filter::LowPass;
use crate::math;

/// Cut-off of the measured pressure, rad/s (13 Hz).
const PRESSURE_CUTOFF: f32 = 80.0;
/// Cut-off of the thrust that is fed forward, rad/s: the asked thrust acts after the motors' 50 ms, less the
/// time that the servo needs itself.
const THRUST_CUTOFF: f32 = 30.0;

/// The contact pressure of one arm, or why there is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pressure {
    /// Pa.
    Known(f32),
    /// Nothing fresh.
    #[default]
    Stale,
    /// The sensor is open, shorted or out of range.
    Faulty,
}

impl Pressure {
    /// The pressure, when it is known and a number; limited, so that filters cannot overflow.
    pub(super) fn known(self) -> Option<f32> {
        match self {
            Self::Known(p) if p.is_finite() => Some(math::clamp(p, 0.0, 1e6)),
            _ => None,
        }
    }
}

/// What one arm is to do in a step, and what is known of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmInput {
    /// Closes the arm; releases it otherwise.
    pub close: bool,
    /// Contact pressure.
    pub pressure: Pressure,
    /// Thrust asked of the arm's rotor, N; 0 when it is stopped.
    pub thrust: f32,
    /// Tension that the servo can be giving, N.
    pub tension: Option<f32>,
    /// Tilt by the arm's own sensor, rad.
    pub tilt: Option<f32>,
}

/// The input within its bounds, pressure and thrust low-passed; `None` where there is none, or no number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// The pressure as it came in.
    pub sensed: Pressure,
    /// Contact pressure, Pa.
    pub pressure: Option<f32>,
    /// Thrust asked of the rotor, N.
    pub thrust: Option<f32>,
    /// Tension that the servo can be giving, N.
    pub tension: Option<f32>,
    /// Tilt, rad.
    pub tilt: Option<f32>,
}

/// The low passes on one arm's input; each settles at its first value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct InputFilters {
    pressure: Option<LowPass>,
    thrust: Option<LowPass>,
}

impl InputFilters {
    /// One step of `dt` s.
    pub fn step(&mut self, input: &ArmInput, dt: f32) -> Measured {
        let pressure = input.pressure.known().map(|p| {
            let filter = self.pressure.get_or_insert(LowPass::at(p));
            filter.step(p, PRESSURE_CUTOFF, dt)
        });
        let thrust = input.thrust.is_finite().then(|| {
            let thrust = math::clamp(input.thrust, 0.0, 1e3);
            let filter = self.thrust.get_or_insert(LowPass::at(thrust));
            filter.step(thrust, THRUST_CUTOFF, dt)
        });
        let tension = input.tension.filter(|t| t.is_finite());
        Measured {
            sensed: input.pressure,
            pressure,
            thrust,
            tension: tension.map(|t| math::clamp(t, 0.0, 1e4)),
            tilt: input.tilt.filter(|t| t.abs() <= math::PI),
        }
    }

    /// The last pressure, Pa; 0 before the first.
    pub fn pressure(&self) -> f32 {
        self.pressure.map_or(0.0, |f| f.value())
    }
}

/// All that the pressure loop needs of an arm, in a step in which nothing is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    /// Contact pressure, Pa.
    pub pressure: f32,
    /// Force of the tendon that meets the rotor's thrust, N.
    pub feed_forward: f32,
    /// Tension of the tendon, N; the force asked for when it is not known.
    pub tension: f32,
    /// Tilt, rad.
    pub tilt: f32,
}

impl Contact {
    /// True while the sensor feels something.
    pub fn touches(&self) -> bool {
        self.pressure > super::TOUCH_PRESSURE
    }
}
