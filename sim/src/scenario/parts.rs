//! Tendons, servos and arm sensors as built: what a file says of each, put together for the plant.

use sophie_control::allocation::wrench::PerArm;

use super::Scenario;
use crate::plant::tendon::{ServoErrors, ServoSpec, TendonSpec};
use crate::sensors::fsr::FsrErrors;

/// Temperature at which calibrations were made and labels hold, °C.
pub const ROOM: f64 = 23.0;

/// The four tendons with their reels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tendons {
    /// Stiffness along each, N/m.
    pub stiffness: PerArm<f64>,
    /// Friction in each channel.
    pub friction: PerArm<f64>,
    /// Creep, share of the stretch per decade of time.
    pub creep: f64,
    /// Radius of each reel over the nominal one.
    pub reel_radius: PerArm<f64>,
    /// Lever of each tendon over the nominal one.
    pub lever: PerArm<f64>,
}

impl Default for Tendons {
    fn default() -> Self {
        Self {
            stiffness: [TendonSpec::default().stiffness; 4],
            friction: [0.0; 4],
            creep: 0.0,
            reel_radius: [1.0; 4],
            lever: [1.0; 4],
        }
    }
}

/// Errors of the four servos that their label leaves out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Servos {
    /// Half width of the band in which they stop, rad.
    pub stop: f64,
    /// Backlash, rad.
    pub backlash: f64,
    /// Sag, rad/(N·m).
    pub sag: f64,
    /// Drift of each zero with the temperature, rad/K, winding positive.
    pub drift: PerArm<f64>,
    /// Stall torque of each over its label's.
    pub stall: PerArm<f64>,
    /// Rise of their temperature at stall, K.
    pub heat: f64,
}

impl Default for Servos {
    fn default() -> Self {
        Self {
            stop: 0.0,
            backlash: 0.0,
            sag: 0.0,
            drift: [0.0; 4],
            stall: [1.0; 4],
            heat: 0.0,
        }
    }
}

/// Errors of the four pressure sensors, each as in [`FsrErrors`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureSensors {
    /// Turn-on force of each, N.
    pub turn_on: PerArm<f64>,
    /// Preload of each, N per radian of tilt.
    pub preload: PerArm<f64>,
    /// Half width of the hysteresis, share.
    pub hysteresis: f64,
    /// Drift, share per decade of time.
    pub drift: f64,
    /// Change of the reading, share per kelvin.
    pub temperature: f64,
    /// Share of the contact that each pad has.
    pub pad_share: PerArm<f64>,
}

impl Default for PressureSensors {
    fn default() -> Self {
        let nominal = FsrErrors::default();
        Self {
            turn_on: [nominal.turn_on; 4],
            preload: [nominal.preload; 4],
            hysteresis: nominal.hysteresis,
            drift: nominal.drift,
            temperature: 0.0,
            pad_share: [nominal.pad_share; 4],
        }
    }
}

impl Scenario {
    /// Factor on the elastic tilt of `arm`, 0 to 3, at the day's temperature: TPU softens by a share a kelvin.
    #[must_use]
    pub fn arm_softness(&self, arm: usize) -> f64 {
        let v = &self.vehicle;
        let warmer = v.arm_warming * (self.world.temperature - ROOM);
        v.arm_gain[arm] * libm::exp(warmer)
    }

    /// The servo of `arm`, 0 to 3, on the day's temperature.
    #[must_use]
    pub fn servo_on(&self, arm: usize) -> ServoSpec {
        let (v, parts) = (&self.vehicle, &self.vehicle.servos);
        let label = ServoSpec::from(v.servo).marked(
            v.servo_release[arm],
            v.servo_full[arm],
            self.params.servo_frame_rate,
        );
        ServoSpec {
            stall: label.stall * parts.stall[arm],
            errors: ServoErrors {
                stop: parts.stop,
                backlash: parts.backlash,
                sag: parts.sag,
                zero: parts.drift[arm] * (self.world.temperature - ROOM),
                heat: parts.heat,
                air: self.world.temperature,
            },
            ..label
        }
    }

    /// The tendon of `arm`, 0 to 3, with its reel.
    #[must_use]
    pub fn tendon_on(&self, arm: usize) -> TendonSpec {
        let parts = &self.vehicle.tendons;
        let nominal = TendonSpec::of(self.vehicle.arm_bending);
        TendonSpec {
            reel_radius: nominal.reel_radius * parts.reel_radius[arm],
            lever: nominal.lever * parts.lever[arm],
            stiffness: parts.stiffness[arm],
            slack_error: self.faults.tendon_slack[arm],
            friction: parts.friction[arm],
            creep: parts.creep,
            ..nominal
        }
    }

    /// The pressure sensor of `arm`, 0 to 3, on the day's temperature.
    #[must_use]
    pub fn fsr_on(&self, arm: usize) -> FsrErrors {
        let parts = &self.sensors.pressure;
        FsrErrors {
            turn_on: parts.turn_on[arm],
            preload: parts.preload[arm],
            hysteresis: parts.hysteresis,
            drift: parts.drift,
            warmth: 1.0 + parts.temperature * (self.world.temperature - ROOM),
            pad_share: parts.pad_share[arm],
        }
    }
}
