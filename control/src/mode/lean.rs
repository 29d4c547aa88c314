//! The lean across the pipe: whether the vehicle stays on the crown, slides off it, or hangs too far to let go.

use super::Motion;
use crate::math::deg;
use crate::support::{Held, LEAVING_FORCE, RESTING_FORCE, Support};

/// Lean beyond which a vehicle that rests on the pipe leaves it before the arms have begun to close, rad.
const TOUCH_LEAN: f32 = deg(13.0);
/// Rate at which a lean goes back, rad/s: then the attitude loop is about to set the vehicle upright.
const LEVELLING_RATE: f32 = 0.2;
/// Lean beyond which arms that close do not hold any more, rad: they need 1.3 s to touch, a slide from here takes 0.35 s
/// to the flank.
const HOPELESS_LEAN: f32 = deg(25.0);
/// Lean from which on a growing one counts, rad, and its rate, rad/s. A touch 30 mm beside the crown drifts out to 14
/// to 18° before it sits, and is held.
const GROWING_LEAN: f32 = deg(18.0);
const GROWING_RATE: f32 = 0.3;
/// Time for which any of it must last, s: three steps.
const SLIDE_TIME: f32 = 0.03;
/// Largest lean at which the arms let go, rad: beyond, the belly slides down the flank before the rotors carry.
const RELEASE_LEAN_MAX: f32 = deg(17.0);
/// Time for which next to nothing may carry a vehicle, s, whose collective is below this share of its weight.
const FALL_TIME: f32 = 0.05;
const FALL_SHARE: f32 = 0.8;

/// What the lean has done over the last steps.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lean {
    /// Roll, rad; that of the last attitude known.
    roll: f32,
    sliding: Held,
    leaning: Held,
    falling: Held,
}

impl Lean {
    /// One step of `dt` s with the support and the collective (N) that the rotors had.
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

    /// The lean is beyond what closing arms can hold, or on its way there.
    pub fn slides(&self) -> bool {
        self.sliding.time() >= SLIDE_TIME
    }

    /// Leans where a vehicle that means to perch feels the pipe.
    pub fn slides_at_touch(&self, support: &Support) -> bool {
        self.leaning.time() >= SLIDE_TIME && support.force() > RESTING_FORCE
    }

    /// Leans too far for the arms to let go.
    pub fn too_far_to_release(&self) -> bool {
        self.roll.abs() > RELEASE_LEAN_MAX
    }

    /// Neither the pipe nor the rotors carry the vehicle.
    pub fn falls(&self) -> bool {
        self.falling.time() >= FALL_TIME
    }
}
