//! Lean across the pipe: whether the vehicle stays on the crown, slides off, or leans too far to let go.

use super::Motion;
use crate::math::deg;
use crate::support::{Held, LEAVING_FORCE, RESTING_FORCE, Support};

/// Lean at which a resting vehicle leaves before closing, rad.
const TOUCH_LEAN: f32 = deg(13.0);
/// Rate at which the attitude loop reduces a lean, rad/s.
const LEVELLING_RATE: f32 = 0.2;
/// Lean too large for closing arms, rad: they touch after 1.3 s, a slide reaches the flank in 0.35 s.
const HOPELESS_LEAN: f32 = deg(25.0);
/// Lean (rad) and rate (rad/s) of a growing lean. A touch 30 mm beside the crown drifts to 14 to 18° before it sits and
/// is held.
const GROWING_LEAN: f32 = deg(18.0);
const GROWING_RATE: f32 = 0.3;
/// Time that these must last, s: three steps.
const SLIDE_TIME: f32 = 0.03;
/// Largest lean at which the arms let go, rad: beyond, the belly slides down the flank before the rotors carry.
const RELEASE_LEAN_MAX: f32 = deg(17.0);
/// A fall: time (s) with little support at a collective below this share of weight.
const FALL_TIME: f32 = 0.05;
const FALL_SHARE: f32 = 0.8;

#[derive(Clone, Copy, Debug, Default)]
pub struct Lean {
    /// Last known roll, rad.
    roll: f32,
    sliding: Held,
    leaning: Held,
    falling: Held,
}

impl Lean {
    /// One step of `dt` s with the rotors' collective (N).
    pub fn step(&mut self, motion: Option<Motion>, support: &Support, collective: f32, dt: f32) {
        self.follow(motion, dt);
        let idle = support.force() < LEAVING_FORCE;
        let low = collective < FALL_SHARE * support.weight();
        self.falling.step(idle && low, dt);
    }

    fn follow(&mut self, motion: Option<Motion>, dt: f32) {
        let Some(motion) = motion else {
            (self.sliding, self.leaning) = Default::default();
            return;
        };
        (self.roll, _, _) = motion.q.to_euler();
        let lean = self.roll.abs();
        let outward = if self.roll > 0.0 {
            motion.rate.x
        } else {
            -motion.rate.x
        };
        let grows = lean > GROWING_LEAN && outward > GROWING_RATE;
        self.sliding.step(lean > HOPELESS_LEAN || grows, dt);
        self.leaning
            .step(lean > TOUCH_LEAN && outward > -LEVELLING_RATE, dt);
    }

    /// The lean is or will be beyond closing arms.
    pub fn slides(&self) -> bool {
        self.sliding.time() >= SLIDE_TIME
    }

    /// A vehicle about to perch leans at the touch.
    pub fn slides_at_touch(&self, support: &Support) -> bool {
        self.leaning.time() >= SLIDE_TIME && support.force() > RESTING_FORCE
    }

    pub fn too_far_to_release(&self) -> bool {
        self.roll.abs() > RELEASE_LEAN_MAX
    }

    pub fn falls(&self) -> bool {
        self.falling.time() >= FALL_TIME
    }
}
