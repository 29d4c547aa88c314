//! Lean across the pipe: whether the vehicle stays on the crown, slides off, turns, or leans too far to let go.
//!
//! What friction holds is the [seat](crate::contact::friction_limit)'s; less friction than its parameter shows in a lean that grows.
//!
//! A vehicle that is headed off the pipe by ψ turns about the pipe's axis all the same, in its own axes by cos ψ in roll and
//! sin ψ in pitch: the lean is the length of both. Pitch counts from the touch, for before it is the flight's and the pipe's
//! slope, and so does the heading, of which nothing else is known.

use crate::attitude::motion::Motion;
use crate::contact::contact_force::{ContactForce, LEAVING_FORCE, RESTING_FORCE};
use crate::contact::friction_limit::FrictionLimit;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{GRAVITY, deg, sqrt, wrap_pi};
use crate::params::Params;
use crate::pilot::release_throttle::release_thrust;

/// Rate at which the attitude loop reduces a lean, rad/s.
const LEVELLING_RATE: f32 = 0.2;
/// Lean too large for closing arms whatever the friction, rad: they touch after 1.3 s, a slide reaches the flank in 0.35 s.
const HOPELESS_LEAN: f32 = deg(25.0);
/// Lean of a fall beside the pipe, rad: seats on 0.2 to 0.4 m hold 10 to 17° while the arms close, so nothing was to come of it.
const FALL_LEAN: f32 = deg(18.0);
/// Rate of a growing lean, rad/s.
const GROWING_RATE: f32 = 0.3;
/// Growth of the lean since the arms began to close, rad, and its rate, rad/s, that mean less friction than the parameter's: on 0.3
/// of friction the arms' first touch starts a slide at 10 to 14°. A sound closing 45 mm beside the crown grows by 2°.
const CREEP: f32 = deg(6.0);
const CREEP_RATE: f32 = 0.1;
/// Growth since a release began, rad: the rotors take the belly off the pipe, and friction that is less than the parameter's gives
/// way under arms that hold.
const GIVEN: f32 = deg(2.0);
/// Turn of the heading since the touch, rad, and its rate, rad/s, that end a closing: on one pad friction holds no heading, and
/// no grip is proven on a pipe that is more oblique than this (`grip_fit`).
const TWIST: f32 = deg(13.0);
const TWIST_RATE: f32 = 0.1;
/// Time for which a lean must slide, s: three steps.
const SLIDE_TIME: f32 = 0.03;
/// Time after a touch for which a lean is a slide off the pipe, s.
const TOUCH_MEMORY: f32 = 0.5;
/// Largest lean at which the arms let go at all, rad: level rotors pull the vehicle away from the flank up to here.
const RELEASE_LEAN_MAX: f32 = deg(28.0);
/// Lean below which its growth is not known from its rate, rad.
const LEAN_MIN: f32 = deg(1.0);
/// A fall: time (s) with little support at a collective below this share of weight.
const FALL_TIME: f32 = 0.05;
const FALL_SHARE: f32 = 0.8;

#[derive(Clone, Copy, Debug)]
pub struct Lean {
    friction_limit: FrictionLimit,
    /// Share of the weight on the rotors while the arms close, and at least while they open.
    closing_share: f32,
    release_share: f32,
    /// Pitch and yaw in the last moment of free air, rad.
    before: Option<[f32; 2]>,
    /// Last known turn about the pipe, rad, at least 0.
    lean: f32,
    /// Least lean since the arms began to close or to let go, rad.
    lean_at_contact: f32,
    creeping: HoldTimer,
    giving: HoldTimer,
    sliding: HoldTimer,
    leaning: HoldTimer,
    twisting: HoldTimer,
    falling: HoldTimer,
    /// Time since something carried, s.
    apart: HoldTimer,
}

impl Lean {
    pub fn new(p: &Params) -> Self {
        Self {
            friction_limit: FrictionLimit::from_params(p),
            closing_share: p.perch_lift,
            release_share: release_thrust(p) / (p.mass * GRAVITY),
            before: None,
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
        let [level, ahead] =
            *self
                .before
                .insert(match self.before.filter(|_| self.apart.time() < TOUCH_MEMORY) {
                    Some(before) => before,
                    None => [pitch, yaw],
                });
        let (nod, twist) = (pitch - level, wrap_pi(yaw - ahead));
        let lean = sqrt(roll * roll + nod * nod);
        // Body rates are those of roll, pitch and yaw near enough for a growth.
        let outward = (roll * motion.rate.x + nod * motion.rate.y) / lean.max(LEAN_MIN);
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

    /// Friction holds the vehicle once the rotors stand.
    pub fn may_stay(&self) -> bool {
        self.friction_limit.holds(self.lean, 0.0)
    }

    /// No seat holds such a lean while the arms close.
    pub fn beyond_seats(&self) -> bool {
        self.lean > FALL_LEAN
    }

    /// The lean is or will be beyond closing arms.
    pub fn slides(&self) -> bool {
        self.sliding.time() >= SLIDE_TIME
    }

    /// The heading turns away from that of the touch, and still does.
    pub fn twists(&self) -> bool {
        self.twisting.time() >= SLIDE_TIME
    }

    /// The lean has grown since a release began, and still does.
    pub fn gives_way(&self) -> bool {
        self.giving.time() >= SLIDE_TIME
    }

    /// The arms begin to close, or to let go, here.
    pub fn capture_lean(&mut self) {
        self.lean_at_contact = self.lean;
    }

    /// The lean has grown since the arms began to close, and still does: less friction than the parameter's.
    pub fn creeps(&self) -> bool {
        self.creeping.time() >= SLIDE_TIME
    }

    /// A vehicle about to perch leans at the touch, or soon after it.
    pub fn slides_at_touch(&self) -> bool {
        self.leaning.time() >= SLIDE_TIME && self.apart.time() < TOUCH_MEMORY
    }

    /// Friction does not hold the vehicle while the arms let go: the rotors must lift it off.
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
