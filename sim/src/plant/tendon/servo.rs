//! The tendon servos that are fitted.

use std::f64::consts::PI;

/// The tendon servo fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ServoProfile {
    /// 35 kgcm, the paper's claim.
    Paper,
    /// MG996R, datasheet at 4.8 V: 9.4 kgcm.
    Mg996r,
}

/// A servo as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoSpec {
    /// Stall torque, N·m.
    pub stall: f64,
    /// No-load speed, rad/s.
    pub slew: f64,
    /// Travel from `release_us` to `full_us`, rad.
    pub range: f64,
    /// Release position, µs.
    pub release_us: f64,
    /// Pulse after the travel `range`, µs; below `release_us` for a reversed servo.
    pub full_us: f64,
    /// Period of accepted pulses, s: 20 ms for an analog servo.
    pub frame: f64,
    /// Errors that the label leaves out.
    pub errors: ServoErrors,
}

/// Errors of a servo that its label leaves out; all zero: it reaches its target and stays cold.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoErrors {
    /// Half width of the band in which it stops, rad.
    pub stop: f64,
    /// Backlash of its gears, rad.
    pub backlash: f64,
    /// Sag under load, rad/(N·m).
    pub sag: f64,
    /// Shift of its zero, rad, winding positive.
    pub zero: f64,
    /// Rise of its temperature at stall, K.
    pub heat: f64,
    /// Temperature of the air, °C.
    pub air: f64,
}

impl ServoSpec {
    /// This servo with the pulses of its release and full marks, µs, and pulses at `frame_rate` Hz.
    #[must_use]
    pub fn marked(self, release_us: f64, full_us: f64, frame_rate: f32) -> Self {
        Self {
            release_us,
            full_us,
            frame: 1.0 / f64::from(frame_rate),
            ..self
        }
    }
}

impl From<ServoProfile> for ServoSpec {
    fn from(profile: ServoProfile) -> Self {
        let usual = Self {
            stall: 0.0,
            slew: 6.16,
            range: 0.0,
            release_us: 550.0,
            full_us: 2450.0,
            frame: 0.02,
            errors: ServoErrors::default(),
        };
        match profile {
            // 35 kgcm (paper); speed of the MG996R it names; 270° version.
            ServoProfile::Paper => Self {
                stall: 3.432,
                range: 4.71,
                ..usual
            },
            // 9.4 kgcm, 0.17 s for 60° at 4.8 V (datasheet); 180°.
            ServoProfile::Mg996r => Self {
                stall: 0.922,
                range: PI,
                ..usual
            },
        }
    }
}
