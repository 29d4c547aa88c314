//! Drive of one tendon, at the servo frame rate: servo angle for force and tilt, and estimated tension.

use super::Reel;
use crate::maths::filter::CascadedLowPass;
use crate::maths::scalar;
use crate::pilot::actuator_test::{PULSE_MAX_US, PULSE_MIN_US};

/// Least tension reported until the servo is back at its release position, N.
const RESIDUAL_TENSION: f32 = 0.5;
/// Pay-out speed, rad/s: half the servo's, so that the arms spring back gently.
const PAY_OUT_SPEED: f32 = 3.0;
/// Servo speed in an actuator test, rad/s: half a second until the stop key is pressed moves it by half a radian.
pub const BENCH_SPEED: f32 = 1.0;
/// Cut-off of each of the two tilt low-passes, rad/s: a loop gain below 1 at the taut arm's mode (8 Hz, Q about 5) with
/// the static gain k h² / (k h² + arm) of 0.7 to 0.85.
pub const TILT_CUTOFF: f32 = 25.0;
/// Cut-off at standstill, rad/s: 4 mrad of sensor noise would otherwise move the grip by 30 Pa.
const STILL_CUTOFF: f32 = 5.0;
/// Difference of tilt and filter above which the arm is moving, rad.
const TILT_MOVING: f32 = 0.04;
/// Largest plausible servo angle, rad.
pub(super) const ANGLE_MAX: f32 = 6.5;
/// Largest plausible tilt, rad.
const TILT_MAX: f32 = 2.5;

/// Output of a tendon's drive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Drive {
    /// Pulse width, µs.
    pub pulse_us: f32,
    /// Estimated tension, N; 0 only once the servo is back at its release position.
    pub tension: f32,
    /// Held for lack of a tilt.
    pub held: bool,
}

/// Drive of one tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonDrive {
    /// Commanded servo angle, rad from release.
    angle: f32,
    /// Measured tilt, low-passed, rad.
    tilt: Option<CascadedLowPass>,
    /// Cut-off at the last step, rad/s.
    cutoff: f32,
    /// A test pulse has moved it, perhaps beyond the travel, and it has not returned to release.
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

    /// Resumes with the servo at `angle` (rad from release), as the last run left it.
    pub fn resume(self, angle: f32) -> Self {
        Self {
            angle: scalar::clamp(angle, 0.0, ANGLE_MAX),
            ..self
        }
    }

    /// Assumes the servo where its tendon is just taut at `tilt` (rad; `None`: at release), so that a tendon found
    /// wound is paid out at the drive's speed.
    pub fn seed_from_tilt(&mut self, reel: &Reel, tilt: Option<f32>) {
        self.angle = tilt
            .filter(|t| t.abs() <= TILT_MAX)
            .map_or(0.0, |tilt| reel.angle(0.0, tilt));
    }

    /// Commanded servo angle, rad from release.
    pub fn angle(&self) -> f32 {
        self.angle
    }

    /// One step of `dt` s towards `force` (N) at the arm's measured tilt (rad). A force of 0 or not finite pays out to
    /// release; otherwise a missing tilt holds the servo.
    pub fn step(&mut self, reel: &Reel, force: f32, tilt: Option<f32>, dt: f32) -> Drive {
        let dt = scalar::clamp(dt, 0.0, 0.2);
        let force = scalar::clamp(force, 0.0, reel.limit.asked);
        let tilt = tilt.filter(|t| t.abs() <= TILT_MAX);
        self.filter_tilt(tilt, dt);
        let pays_out = force <= 0.0;
        let held = !pays_out && tilt.is_none();
        if pays_out {
            self.angle = scalar::slew(self.angle, 0.0, PAY_OUT_SPEED * dt);
            self.placed &= self.angle != 0.0;
        } else if let Some(filtered) = self.tilt.filter(|_| !held) {
            let target = reel.angle(force, filtered.value());
            let speed = if target > self.angle {
                reel.speed(self.tension(reel))
            } else {
                reel.speed(0.0)
            };
            self.angle = scalar::slew(self.angle, target, speed * dt);
        }
        self.output(reel, held)
    }

    /// One step of `dt` s towards `pulse_us` (µs) at `BENCH_SPEED`, within the range of servos.
    pub fn place(&mut self, reel: &Reel, pulse_us: f32, tilt: Option<f32>, dt: f32) -> Drive {
        let dt = scalar::clamp(dt, 0.0, 0.2);
        self.filter_tilt(tilt.filter(|t| t.abs() <= TILT_MAX), dt);
        let target = reel.angle_of(scalar::clamp(pulse_us, PULSE_MIN_US, PULSE_MAX_US));
        self.angle = scalar::slew(self.angle, target, BENCH_SPEED * dt);
        self.placed = true;
        self.output(reel, false)
    }

    /// One step of `dt` s that holds the servo and only filters the tilt (rad).
    pub fn hold_position(&mut self, reel: &Reel, tilt: Option<f32>, dt: f32) -> Drive {
        self.filter_tilt(tilt.filter(|t| t.abs() <= TILT_MAX), scalar::clamp(dt, 0.0, 0.2));
        self.output(reel, true)
    }

    fn filter_tilt(&mut self, tilt: Option<f32>, dt: f32) {
        let Some(tilt) = tilt else {
            return;
        };
        let filter = self.tilt.get_or_insert(CascadedLowPass::at(tilt));
        let moving = scalar::clamp((tilt - filter.value()).abs() / TILT_MOVING, 0.0, 1.0);
        self.cutoff = STILL_CUTOFF + (TILT_CUTOFF - STILL_CUTOFF) * moving;
        filter.step(tilt, self.cutoff, dt);
    }

    /// The output without a step, when the order is missing.
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
                scalar::clamp(tension, RESIDUAL_TENSION, f32::MAX)
            } else {
                0.0
            },
            held,
        }
    }

    /// Tension at the present tilt: the filtered one extrapolated over lag and age, exact for an even motion.
    fn tension(&self, reel: &Reel) -> f32 {
        self.tilt.map_or(0.0, |tilt| {
            let now = tilt.value() + tilt.lead() * (2.0 + reel.tilt_age * self.cutoff);
            reel.force(self.angle, scalar::clamp_abs(now, TILT_MAX))
        })
    }
}
