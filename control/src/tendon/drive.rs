//! The drive of one tendon: the servo's angle by force and tilt, and the tension that it can be giving.

use super::Reel;
use crate::bench::{PULSE_MAX_US, PULSE_MIN_US};
use crate::filter::CascadedLowPass;
use crate::math;

/// Tension (N) that is reported at least until the servo is back at its release position.
const RESIDUAL_TENSION: f32 = 0.5;
/// Speed of paying out on release, rad/s: half the servo's, the arms spring back gently.
const PAY_OUT_SPEED: f32 = 3.0;
/// Speed of a servo on the bench, rad/s: half a second from a word to the key that stops it is half a radian.
pub const BENCH_SPEED: f32 = 1.0;
/// Cut-off of each of the two low passes on the tilt, rad/s: a loop gain below 1 at the taut arm's mode
/// (8 Hz, Q about 5) with the static gain k h² / (k h² + arm) of 0.7 to 0.85.
pub const TILT_CUTOFF: f32 = 25.0;
/// The same while the arm stands still, rad/s: a sensor noise of 4 mrad would else move the grip by 30 Pa.
const STILL_CUTOFF: f32 = 5.0;
/// Distance of the tilt from its filter from which the arm counts as moving, rad.
const TILT_MOVING: f32 = 0.04;
/// Angles beyond this are no servo's, rad.
pub(super) const ANGLE_MAX: f32 = 6.5;
/// Tilts beyond this are not an arm's, rad.
const TILT_MAX: f32 = 2.5;

/// What the drive of one tendon puts out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Pulse width, µs.
    pub pulse_us: f32,
    /// Tension that the servo can be giving now, N; 0 only once it is back at its release position.
    pub tension: f32,
    /// The servo was held because the tilt is missing.
    pub held: bool,
}

/// The drive of one tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonDrive {
    /// Angle to which the servo is sent, rad from release.
    angle: f32,
    /// Measured tilt, low-passed, rad.
    tilt: Option<CascadedLowPass>,
    /// Cut-off of its low passes at the last step, rad/s.
    cutoff: f32,
    /// Sent by a pulse of the bench, perhaps beyond its travel, and not back at its release mark yet.
    placed: bool,
}

impl Default for TendonDrive {
    fn default() -> Self {
        Self::new()
    }
}

impl TendonDrive {
    /// A drive at its release position.
    pub const fn new() -> Self {
        Self {
            angle: 0.0,
            tilt: None,
            cutoff: TILT_CUTOFF,
            placed: false,
        }
    }

    /// The same drive, its servo at `angle` (rad from release), where the run before left it.
    pub fn resume(self, angle: f32) -> Self {
        Self {
            angle: math::clamp(angle, 0.0, ANGLE_MAX),
            ..self
        }
    }

    /// Takes the servo to stand where its tendon is just taut at the tilt `tilt` (rad; `None`: at release). For a
    /// tendon that was wound at power-on and is to be paid out: from there on it moves at the drive's speed, not the
    /// servo's.
    pub fn seed_from_tilt(&mut self, reel: &Reel, tilt: Option<f32>) {
        self.angle = tilt
            .filter(|t| t.abs() <= TILT_MAX)
            .map_or(0.0, |tilt| reel.angle(0.0, tilt));
    }

    /// Angle to which the servo is sent, rad from release.
    pub fn angle(&self) -> f32 {
        self.angle
    }

    /// One step of `dt` s towards `force` N (0, or anything that is no number: pay out to the release
    /// position) with the arm's measured tilt (rad).
    ///
    /// Without a tilt the servo is held where it is, unless it is to pay out, which needs none.
    pub fn step(&mut self, reel: &Reel, force: f32, tilt: Option<f32>, dt: f32) -> Drive {
        let dt = math::clamp(dt, 0.0, 0.2);
        let force = math::clamp(force, 0.0, reel.limit.asked);
        let tilt = tilt.filter(|t| t.abs() <= TILT_MAX);
        self.filter_tilt(tilt, dt);
        let pays_out = force <= 0.0;
        let held = !pays_out && tilt.is_none();
        if pays_out {
            self.angle = math::slew(self.angle, 0.0, PAY_OUT_SPEED * dt);
            self.placed &= self.angle != 0.0;
        } else if let Some(filtered) = self.tilt.filter(|_| !held) {
            let target = reel.angle(force, filtered.value());
            let speed = if target > self.angle {
                reel.speed(self.tension(reel))
            } else {
                reel.speed(0.0)
            };
            self.angle = math::slew(self.angle, target, speed * dt);
        }
        self.output(reel, held)
    }

    /// One step of `dt` s towards the pulse `pulse_us` (µs), at `BENCH_SPEED` and as far as servos go.
    pub fn place(&mut self, reel: &Reel, pulse_us: f32, tilt: Option<f32>, dt: f32) -> Drive {
        let dt = math::clamp(dt, 0.0, 0.2);
        self.filter_tilt(tilt.filter(|t| t.abs() <= TILT_MAX), dt);
        let target = reel.angle_of(math::clamp(pulse_us, PULSE_MIN_US, PULSE_MAX_US));
        self.angle = math::slew(self.angle, target, BENCH_SPEED * dt);
        self.placed = true;
        self.output(reel, false)
    }

    /// One step of `dt` s that leaves the servo where it is and only filters the tilt (rad).
    pub fn hold_position(&mut self, reel: &Reel, tilt: Option<f32>, dt: f32) -> Drive {
        self.filter_tilt(tilt.filter(|t| t.abs() <= TILT_MAX), math::clamp(dt, 0.0, 0.2));
        self.output(reel, true)
    }

    fn filter_tilt(&mut self, tilt: Option<f32>, dt: f32) {
        let Some(tilt) = tilt else {
            return;
        };
        let filter = self.tilt.get_or_insert(CascadedLowPass::at(tilt));
        let moving = math::clamp((tilt - filter.value()).abs() / TILT_MOVING, 0.0, 1.0);
        self.cutoff = STILL_CUTOFF + (TILT_CUTOFF - STILL_CUTOFF) * moving;
        filter.step(tilt, self.cutoff, dt);
    }

    /// The output without a step: for when there is no order at all.
    pub fn hold(&self, reel: &Reel) -> Drive {
        self.output(reel, true)
    }

    fn output(&self, reel: &Reel, held: bool) -> Drive {
        let wound = self.angle > 1e-3;
        let tension = self.tension(reel);
        Drive {
            pulse_us: if self.placed {
                reel.pulse_beyond(self.angle)
            } else {
                reel.pulse(self.angle)
            },
            tension: if wound {
                math::clamp(tension, RESIDUAL_TENSION, f32::MAX)
            } else {
                0.0
            },
            held,
        }
    }

    /// Tension at the present tilt: the filtered one extrapolated over its lag and age, exact for a tilt
    /// that moves evenly.
    fn tension(&self, reel: &Reel) -> f32 {
        self.tilt.map_or(0.0, |tilt| {
            let now = tilt.value() + tilt.lead() * (2.0 + reel.tilt_age * self.cutoff);
            reel.force(self.angle, math::clamp_abs(now, TILT_MAX))
        })
    }
}
