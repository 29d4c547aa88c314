//! Lean across the pipe: whether the vehicle stays on the crown, slides off, twists, or leans too far to release.
//!
//! The [friction limit](crate::contact::friction_limit) is computed from the parameters; if the real friction is lower,
//! the lean grows.
//!
//! A vehicle whose nose points off the pipe by ψ still turns about the pipe's axis, which splits the lean into cos ψ in
//! roll and sin ψ in pitch: the lean is the length of both. Pitch is measured from the value at the touch, since before
//! it pitch belongs to the flight and to the pipe's slope; so is the heading, whose angle to the pipe is unknown.

use crate::attitude::motion::Motion;
use crate::contact::contact_force::{ContactForce, LEAVING_FORCE, RESTING_FORCE};
use crate::contact::friction_limit::FrictionLimit;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{GRAVITY, deg, sqrt, wrap_pi};
use crate::params::Params;
use crate::pilot::release_throttle::release_thrust;

/// Rate at which the attitude loop reduces a lean, rad/s.
const LEVELLING_RATE: f32 = 0.2;
/// Lean too large for closing arms at any friction, rad: they touch after 1.3 s, a slide reaches the flank in 0.35 s.
const HOPELESS_LEAN: f32 = deg(25.0);
/// Lean that proves a fall beside the pipe, rad: pipes of 0.2 to 0.4 m hold 10 to 17° while the arms close, so a perch
/// has failed anyway.
const FALL_LEAN: f32 = deg(18.0);
/// Rate of a growing lean, rad/s.
const GROWING_RATE: f32 = 0.3;
/// Growth of the lean since the arms began to close, rad, and its rate, rad/s, that indicate friction below its
/// parameter: with friction 0.3 the arms' first touch starts a slide at 10 to 14°. A sound closing 45 mm beside the
/// crown grows by 2°.
const CREEP: f32 = deg(6.0);
const CREEP_RATE: f32 = 0.1;
/// Growth of the lean since a release began, rad: the rotors lift the belly off the pipe, and friction below its
/// parameter gives way although the arms hold.
const GIVEN: f32 = deg(2.0);
/// Turn of the heading since the touch, rad, and its rate, rad/s, that end a closing: on one pad friction holds no
/// heading, and a grip on a pipe more oblique than this cannot be proven (`grip_geometry`).
const TWIST: f32 = deg(13.0);
const TWIST_RATE: f32 = 0.1;
/// Time for which a lean must exceed the limit, s: three steps.
const SLIDE_TIME: f32 = 0.03;
/// Time after a touch for which a lean is a slide off the pipe, s.
const TOUCH_MEMORY: f32 = 0.5;
/// Largest lean at which the arms let go at all, rad: level rotors pull the vehicle away from the flank up to here.
const RELEASE_LEAN_MAX: f32 = deg(28.0);
/// Lean below which its growth cannot be computed from the rates, rad.
const LEAN_MIN: f32 = deg(1.0);
/// Time with little support that indicates a fall, s, at a collective below this share of the weight.
const FALL_TIME: f32 = 0.05;
const FALL_SHARE: f32 = 0.8;

#[derive(Clone, Copy, Debug)]
pub struct Lean {
    friction_limit: FrictionLimit,
    /// Share of the weight on the rotors while the arms close, and the least one while they open.
    closing_share: f32,
    release_share: f32,
    /// Pitch and yaw at the last moment of free air, rad; kept from the touch on.
    pitch_yaw_at_contact: Option<[f32; 2]>,
    /// Last known turn about the pipe, rad, >= 0.
    lean: f32,
    /// Least lean since the arms began to close or to open, rad.
    lean_at_contact: f32,
    creeping: HoldTimer,
    giving: HoldTimer,
    sliding: HoldTimer,
    leaning: HoldTimer,
    twisting: HoldTimer,
    falling: HoldTimer,
    /// Time since the last support, s.
    apart: HoldTimer,
}

impl Lean {
    pub fn new(p: &Params) -> Self {
        Self {
            friction_limit: FrictionLimit::from_params(p),
            closing_share: p.perch_lift,
            release_share: release_thrust(p) / (p.mass * GRAVITY),
            pitch_yaw_at_contact: None,
            lean: 0.0,
            lean_at_contact: 0.0,
            creeping: HoldTimer::default(),
            giving: HoldTimer::default(),
            sliding: HoldTimer::default(),
            leaning: HoldTimer::default(),
            twisting: HoldTimer::default(),
            falling: HoldTimer::default(),
            apart: HoldTimer::default(),
        }
    }

    /// One step of `dt` s with the rotors' collective (N).
    pub fn step(&mut self, motion: Option<Motion>, contact_force: &ContactForce, collective: f32, dt: f32) {
        self.follow(motion, collective / contact_force.weight(), dt);
        let idle = contact_force.force() < LEAVING_FORCE;
        let low = collective < FALL_SHARE * contact_force.weight();
        self.falling.step(idle && low, dt);
        self.apart.step(contact_force.force() <= RESTING_FORCE, dt);
    }

    fn follow(&mut self, motion: Option<Motion>, share: f32, dt: f32) {
        let Some(motion) = motion else {
            (self.sliding, self.leaning, self.twisting) = Default::default();
            return;
        };
        let (roll, pitch, yaw) = motion.q.to_euler();
        let [pitch_at_contact, yaw_at_contact] = *self.pitch_yaw_at_contact.insert(
            match self
                .pitch_yaw_at_contact
                .filter(|_| self.apart.time() < TOUCH_MEMORY)
            {
                Some(captured) => captured,
                None => [pitch, yaw],
            },
        );
        let (pitch_change, twist) = (pitch - pitch_at_contact, wrap_pi(yaw - yaw_at_contact));
        let lean = sqrt(roll * roll + pitch_change * pitch_change);
        // Small angles: body rates approximate the rates of roll, pitch and yaw.
        let outward = (roll * motion.rate.x + pitch_change * motion.rate.y) / lean.max(LEAN_MIN);
        self.lean = lean;
        let grows = outward > GROWING_RATE && !self.friction_limit.holds(lean, share);
        self.sliding.step(lean > HOPELESS_LEAN || grows, dt);
        self.lean_at_contact = lean.min(self.lean_at_contact);
        let creeps = lean > self.lean_at_contact + CREEP && outward > CREEP_RATE;
        self.creeping.step(creeps, dt);
        let gives = lean > self.lean_at_contact + GIVEN && outward > CREEP_RATE;
        self.giving.step(gives, dt);
        let twists =
            twist > TWIST && motion.rate.z > TWIST_RATE || twist < -TWIST && motion.rate.z < -TWIST_RATE;
        self.twisting.step(twists, dt);
        self.leaning
            .step(!self.may_close() && outward > -LEVELLING_RATE, dt);
    }

    /// Friction holds the vehicle while the arms close.
    pub fn may_close(&self) -> bool {
        self.friction_limit.holds(self.lean, self.closing_share)
    }

    /// Friction and the arms hold the vehicle once the rotors have stopped, against wind too.
    pub fn may_stay(&self) -> bool {
        self.friction_limit.holds_pushed(self.lean)
    }

    /// The lean exceeds the friction limit of any pipe while the arms close.
    pub fn beyond_seats(&self) -> bool {
        self.lean > FALL_LEAN
    }

    /// The lean exceeds, or will exceed, the limit for closing arms.
    pub fn slides(&self) -> bool {
        self.sliding.time() >= SLIDE_TIME
    }

    /// The heading turns away from that of the touch, and keeps turning.
    pub fn twists(&self) -> bool {
        self.twisting.time() >= SLIDE_TIME
    }

    /// The lean has grown since a release began, and keeps growing.
    pub fn gives_way(&self) -> bool {
        self.giving.time() >= SLIDE_TIME
    }

    /// Captures the lean at which the arms begin to close or to open.
    pub fn capture_lean(&mut self) {
        self.lean_at_contact = self.lean;
    }

    /// The lean has grown since the arms began to close, and keeps growing: friction is below its parameter.
    pub fn creeps(&self) -> bool {
        self.creeping.time() >= SLIDE_TIME
    }

    /// A vehicle about to perch exceeds the friction limit at the touch, or soon after it.
    pub fn slides_at_touch(&self) -> bool {
        self.leaning.time() >= SLIDE_TIME && self.apart.time() < TOUCH_MEMORY
    }

    /// Friction does not hold the vehicle while the arms open: the rotors must lift it off.
    pub fn lifts_off(&self) -> bool {
        !self.friction_limit.holds(self.lean, self.release_share)
    }

    pub fn too_far_to_release(&self) -> bool {
        self.lean > RELEASE_LEAN_MAX
    }

    pub fn falls(&self) -> bool {
        self.falling.time() >= FALL_TIME
    }
}
