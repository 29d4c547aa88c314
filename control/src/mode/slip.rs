//! A perched body that turns about the pipe, at once or creeping: the arms tighten, a few times, and it is named when it
//! does not help.
//!
//! With the rotors stopped a turn of the body is one of the arms on the pipe: friction gives way at R μ ΣN, so pressure
//! is what answers it.

use super::{Motion, Reason};
use crate::math::{clamp, deg, slew};
use crate::support::Held;

/// Turn since the grip was proven, or tightened last, that is a creep, rad, and the time that it must last, s: a gust
/// passes. Friction that fails slowly gives so much before it gives way (measured in the plant).
const CREEP: (f32, f32) = (deg(0.5), 0.5);
/// Rate at which that reference follows, rad/s: an accelerometer that drifts by 10 mg turns no more than 0.6° in minutes.
const DRIFT: f32 = deg(0.005);
/// Turn and outward rate, rad/s, that are a slip, and their time, s: a lean grows e-fold in 0.16 s once friction gives way.
const SLIP: (f32, f32, f32) = (deg(1.0), 0.05, 0.03);
/// Least time between answers, s: the pressure follows its reference in 0.25 s.
pub const ANSWER_TIME: f32 = 0.3;

/// See the module's text.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip {
    /// Roll and pitch from which turns count, rad.
    from: Option<[f32; 2]>,
    creeps: Held,
    slips: Held,
    /// Since the last answer, s.
    since: f32,
    /// No answer was left.
    helpless: bool,
}

impl Slip {
    /// One step of `dt` s; true where the arms are to tighten, which they `may`.
    pub fn step(&mut self, motion: Motion, may: bool, dt: f32) -> bool {
        let (roll, pitch, _) = motion.q.to_euler();
        let [from_roll, from_pitch] = self.from.get_or_insert([roll, pitch]);
        *from_roll = slew(*from_roll, roll, DRIFT * dt);
        *from_pitch = slew(*from_pitch, pitch, DRIFT * dt);
        let (turned, nodded) = (roll - *from_roll, pitch - *from_pitch);
        let turn = turned.abs().max(nodded.abs());
        // Body rates are those of roll and pitch near enough for a sign.
        let outward = if turned.abs() > nodded.abs() {
            motion.rate.x * sign(turned)
        } else {
            motion.rate.y * sign(nodded)
        };
        self.creeps.step(turn > CREEP.0, dt);
        self.slips.step(turn > SLIP.0 && outward > SLIP.1, dt);
        self.since = clamp(self.since + dt, 0.0, 1e3);
        let due = self.creeps.time() >= CREEP.1 || self.slips.time() >= SLIP.2;
        self.helpless = due && !may;
        let answers = due && may && self.since >= ANSWER_TIME;
        if answers {
            *self = Self {
                from: Some([roll, pitch]),
                ..Self::default()
            };
        }
        answers
    }

    /// It goes on turning.
    pub fn reason(&self) -> Option<Reason> {
        self.helpless.then_some(Reason::Slips)
    }
}

fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}
