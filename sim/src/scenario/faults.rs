//! Faults of the vehicle's parts, which neither stack nor pilot knows.

use sophie_control::allocation::wrench::PerArm;

use crate::plant::tendon::TendonBreak;
use crate::sensors::arm_imu::TiltBreak;
use crate::sensors::fsr::FsrBreak;

/// Faults of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Faults {
    /// Begin of the faults, s after power-up.
    pub at: f64,
    /// Pressure sensors.
    pub pressure: PerArm<Option<FsrBreak>>,
    /// Tilt sensors.
    pub tilt: PerArm<Option<TiltBreak>>,
    /// Tendons with their servos.
    pub tendon: PerArm<Option<TendonBreak>>,
    /// Reading of each pressure sensor over the nominal one, from power-up; nominal 1.
    pub pressure_gain: PerArm<f64>,
    /// Offset of each tilt sensor, from power-up, rad.
    pub tilt_offset: PerArm<f64>,
    /// Length of each tendon over its own, m; negative: too short.
    pub tendon_slack: PerArm<f64>,
    /// Time of the permanent loss of the radio, s after power-up.
    pub radio_at: Option<f64>,
}

impl Default for Faults {
    fn default() -> Self {
        Self {
            at: 0.0,
            pressure: [None; 4],
            tilt: [None; 4],
            tendon: [None; 4],
            pressure_gain: [1.0; 4],
            tilt_offset: [0.0; 4],
            tendon_slack: [0.0; 4],
            radio_at: None,
        }
    }
}

impl Faults {
    /// Gain of the pressure sensor of `arm`, 0 to 3, and its fault with the time, s after power-up, when it begins.
    #[must_use]
    pub fn pressure(&self, arm: usize) -> (f64, Option<(FsrBreak, f64)>) {
        let gain = self.pressure_gain.get(arm).copied().unwrap_or(1.0);
        let broken = self.pressure.get(arm).copied().flatten();
        (gain, broken.map(|broken| (broken, self.at)))
    }

    /// Offset of the tilt sensor of `arm`, 0 to 3, rad, and its fault with the time, s after power-up, when it begins.
    #[must_use]
    pub fn tilt(&self, arm: usize) -> (f64, Option<(TiltBreak, f64)>) {
        let offset = self.tilt_offset.get(arm).copied().unwrap_or(0.0);
        let broken = self.tilt.get(arm).copied().flatten();
        (offset, broken.map(|broken| (broken, self.at)))
    }
}

/// Word for a part without a fault.
pub const SOUND: &str = "sound";
/// Words for a pressure sensor.
pub const PRESSURE: &[&str] = &[SOUND, "open", "short", "stuck"];
/// Words for a tilt sensor.
pub const TILT: &[&str] = &[SOUND, "silent", "stuck"];
/// Words for a tendon.
pub const TENDON: &[&str] = &[SOUND, "torn", "stuck"];

/// A word from [`PRESSURE`].
pub fn pressure(word: &str) -> Option<FsrBreak> {
    match word {
        "open" => Some(FsrBreak::Open),
        "short" => Some(FsrBreak::Short),
        "stuck" => Some(FsrBreak::Stuck),
        _ => None,
    }
}

/// A word from [`TILT`].
pub fn tilt(word: &str) -> Option<TiltBreak> {
    match word {
        "silent" => Some(TiltBreak::Silent),
        "stuck" => Some(TiltBreak::Stuck),
        _ => None,
    }
}

/// A word from [`TENDON`].
pub fn tendon(word: &str) -> Option<TendonBreak> {
    match word {
        "torn" => Some(TendonBreak::Torn),
        "stuck" => Some(TendonBreak::Stuck),
        _ => None,
    }
}

/// The word of a pressure sensor.
#[must_use]
pub const fn pressure_word(broken: Option<FsrBreak>) -> &'static str {
    match broken {
        None => SOUND,
        Some(FsrBreak::Open) => "open",
        Some(FsrBreak::Short) => "short",
        Some(FsrBreak::Stuck) => "stuck",
    }
}

/// The word of a tilt sensor.
#[must_use]
pub const fn tilt_word(broken: Option<TiltBreak>) -> &'static str {
    match broken {
        None => SOUND,
        Some(TiltBreak::Silent) => "silent",
        Some(TiltBreak::Stuck) => "stuck",
    }
}

/// The word of a tendon.
#[must_use]
pub const fn tendon_word(broken: Option<TendonBreak>) -> &'static str {
    match broken {
        None => SOUND,
        Some(TendonBreak::Torn) => "torn",
        Some(TendonBreak::Stuck) => "stuck",
    }
}
