//! Input of one arm, filtered and validated.

use crate::maths::filter::LowPass;
use crate::maths::scalar;

/// Cut-off of the measured pressure, rad/s (13 Hz).
const PRESSURE_CUTOFF: f32 = 80.0;
/// Cut-off of the thrust fed forward, rad/s: after the motors' 50 ms, less the servo's delay.
const THRUST_CUTOFF: f32 = 30.0;

/// Contact pressure of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Pressure {
    /// Pa.
    Known(f32),
    /// The pressure is stale.
    #[default]
    Stale,
    /// Sensor open, shorted or out of range.
    Faulty,
}

impl Pressure {
    /// A finite pressure, limited so that filters cannot overflow.
    pub(super) fn known(self) -> Option<f32> {
        match self {
            Self::Known(p) if p.is_finite() => Some(scalar::clamp(p, 0.0, 1e6)),
            _ => None,
        }
    }
}

/// Command and measurements of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmInput {
    /// Closes the arm, else releases it.
    pub close: bool,
    /// Contact pressure.
    pub pressure: Pressure,
    /// Contact pressure below which the sensor reads nothing, Pa.
    pub turn_on: f32,
    /// Thrust demanded of the arm's rotor, N; 0 when stopped.
    pub thrust: f32,
    /// Estimated tension, N.
    pub tension: Option<f32>,
    /// Tilt by its sensor, rad.
    pub tilt: Option<f32>,
}

/// Bounded, pressure and thrust low-passed; `None` where missing or not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Measured {
    /// Unfiltered pressure.
    pub sensed: Pressure,
    /// Contact pressure, Pa.
    pub pressure: Option<f32>,
    /// Pressure below which the sensor reads nothing, Pa.
    pub turn_on: f32,
    /// Thrust, N.
    pub thrust: Option<f32>,
    /// Tension, N.
    pub tension: Option<f32>,
    /// Tilt, rad.
    pub tilt: Option<f32>,
}

/// Low passes on one arm's input; each settles at its first value.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct InputFilters {
    pressure: Option<LowPass>,
    thrust: Option<LowPass>,
}

impl InputFilters {
    pub fn step(&mut self, input: &ArmInput, dt: f32) -> Measured {
        let pressure = input.pressure.known().map(|p| {
            let filter = self.pressure.get_or_insert(LowPass::at(p));
            filter.step(p, PRESSURE_CUTOFF, dt)
        });
        let thrust = input.thrust.is_finite().then(|| {
            let thrust = scalar::clamp(input.thrust, 0.0, 1e3);
            let filter = self.thrust.get_or_insert(LowPass::at(thrust));
            filter.step(thrust, THRUST_CUTOFF, dt)
        });
        let tension = input.tension.filter(|t| t.is_finite());
        Measured {
            sensed: input.pressure,
            pressure,
            turn_on: input.turn_on,
            thrust,
            tension: tension.map(|t| scalar::clamp(t, 0.0, 1e4)),
            tilt: input.tilt.filter(|t| t.abs() <= scalar::PI),
        }
    }

    /// Last pressure, Pa; 0 before the first.
    pub fn pressure(&self) -> f32 {
        self.pressure.map_or(0.0, |f| f.value())
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    /// Contact pressure, Pa.
    pub pressure: f32,
    /// Tendon force against the rotor's thrust on the pipe, N.
    pub feed_forward: f32,
    /// Tendon force against the rotor's thrust on a free arm, N.
    pub lifted: f32,
    /// Tension, N; the demanded force if unknown.
    pub tension: f32,
    /// Tilt, rad.
    pub tilt: f32,
}

impl Contact {
    pub fn touches(&self) -> bool {
        self.pressure > super::TOUCH_PRESSURE
    }
}
