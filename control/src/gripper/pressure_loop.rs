//! Pressure loop of a touching arm: a PID with the rotor's thrust fed forward.

use super::input::Contact;
use super::{Config, FORCE_MIN};
use crate::gripper::tendon::TILT_CUTOFF;
use crate::maths::filter::{CascadedLowPass, LowPass};
use crate::maths::scalar;

/// Time constant of the reference's approach to the target, s.
const REFERENCE_TAU: f32 = 0.25;
/// Cut-off of the pressure's derivative, rad/s (6 Hz).
const DERIVATIVE_CUTOFF: f32 = 40.0;
/// Lag of the tendon above which the integral waits, N.
pub(super) const LAG_MAX: f32 = 20.0;
/// Cut-off of the fallback force after a lost touch, rad/s.
const MEAN_FORCE_CUTOFF: f32 = 3.0;

/// Tendon force per pressure on a pipe, N/Pa (94 Pa/N, docs/design/physics.md).
const FORCE_PER_PRESSURE: f32 = 0.0106;
/// Least change of the target that counts as a tightening, Pa.
const TIGHTENED: f32 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureLoop {
    /// Target at the last step, Pa.
    target: Option<f32>,
    /// Commanded less actual force at touch, decaying, N.
    touch_transient: CascadedLowPass,
    /// Mean force of the last third of a second in touch, N.
    mean_force: LowPass,
    reference: f32,
    /// Integral part of the force, N.
    integral: f32,
    last: f32,
    slope: LowPass,
}

impl PressureLoop {
    /// Bumpless start: output `force` N, with `transient` N in it, at the contact's pressure, which becomes the
    /// reference.
    ///
    /// The transient is the force that the tendon lacked while the arm moved and its tilt came late. As the tilt
    /// catches up on the standing arm, the same reel position means the smaller force.
    pub fn new(contact: &Contact, force: f32, transient: f32) -> Self {
        let base = force - transient - contact.feed_forward;
        Self {
            target: None,
            touch_transient: CascadedLowPass::at(transient),
            mean_force: LowPass::at(base + contact.feed_forward),
            reference: contact.pressure,
            integral: base,
            last: contact.pressure,
            slope: LowPass::at(0.0),
        }
    }

    /// One step of `dt` s with the tendon's `lag` (N); returns the force, N.
    pub fn step(&mut self, cfg: &Config, contact: &Contact, lag: f32, dt: f32) -> f32 {
        let tighter = cfg.demand.pressure - self.target.unwrap_or(cfg.demand.pressure);
        self.target = Some(cfg.demand.pressure);
        if tighter > TIGHTENED {
            // A slip needs the pressure at once: the reference jumps.
            self.reference += tighter;
            self.integral += FORCE_PER_PRESSURE * tighter;
        }
        let towards = dt / (REFERENCE_TAU + dt);
        self.reference += (cfg.demand.pressure - self.reference) * towards;
        let error = self.reference - contact.pressure;
        let slope = (contact.pressure - self.last) / dt;
        let slope = self.slope.step(slope, DERIVATIVE_CUTOFF, dt);
        self.last = contact.pressure;
        let transient = self.touch_transient.step(0.0, TILT_CUTOFF, dt);
        let quick = cfg.p * error - cfg.d * slope + contact.feed_forward + transient;
        let force = self.integral + quick;
        let up = force >= cfg.limit || lag > LAG_MAX;
        let down = force <= FORCE_MIN || lag < -LAG_MAX;
        if !(up && error > 0.0 || down && error < 0.0) {
            // The feed-forward alone may exceed the limit; the integral then works against it.
            self.integral = scalar::clamp_abs(self.integral + cfg.i * error * dt, 2.0 * cfg.limit);
        }
        self.integral + quick
    }

    pub fn note_force(&mut self, force: f32, dt: f32) {
        self.mean_force.step(force, MEAN_FORCE_CUTOFF, dt);
    }

    pub fn mean_force(&self) -> f32 {
        self.mean_force.value()
    }
}
