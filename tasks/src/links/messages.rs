//! Messages defined by the tasks: contact, arm angles, status.

use embassy_time::{Duration, Instant};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::arming::ArmingInhibits;
use sophie_control::gripper::contact_pressure::FsrFault;
use sophie_control::mode::{Mode, Reason};

use super::link::Stamped;

/// Contact pressures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Pressure at each arm's sensor, Pa, or the sensor's fault.
    pub arms: PerArm<Result<f32, FsrFault>>,
}

impl Default for Contact {
    /// Healthy sensors without contact.
    fn default() -> Self {
        Self { arms: [Ok(0.0); 4] }
    }
}

/// Tilt of the arms measured by their own sensors; the message is stamped with the oldest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmAngles {
    /// Tilt of each arm, rad, tip up positive, with the time of the request to its sensor; `None` without a reading.
    pub tilt: PerArm<Option<Stamped<f32>>>,
}

impl ArmAngles {
    /// Angles measured together at `at`, rad.
    pub fn at(at: Instant, tilt: PerArm<Option<f32>>) -> Self {
        Self {
            tilt: tilt.map(|tilt| tilt.map(|value| Stamped { at, value })),
        }
    }

    /// When the oldest of them was measured.
    pub fn oldest(&self) -> Option<Instant> {
        self.tilt.iter().flatten().map(|tilt| tilt.at).min()
    }

    /// Those that are not older than `limit` now.
    pub fn within(self, limit: Duration) -> Self {
        Self {
            tilt: self.tilt.map(|tilt| tilt.filter(|t| t.fresh(limit).is_some())),
        }
    }

    /// The angles alone, rad.
    pub fn values(&self) -> PerArm<Option<f32>> {
        self.tilt.map(|tilt| tilt.map(|t| t.value))
    }
}

/// State reported by the commander, for telemetry, log and lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Status {
    /// State of the vehicle.
    pub mode: Mode,
    /// Reason for refused arming or an active failsafe, if any.
    pub reason: Option<Reason>,
    /// Warning that does not affect the modes; empty if there is nothing to report.
    pub warning: &'static str,
    /// Everything that forbids arming now.
    pub inhibits: ArmingInhibits,
}
