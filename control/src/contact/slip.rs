//! Slip of a perched body about the pipe, fast or creeping: the arms tighten a limited number of times; if the body
//! keeps turning, the slip is reported.
//!
//! With the rotors stopped the arms turn on the pipe once the moment exceeds the friction's R μ ΣN, so more pressure
//! stops the slip. Some turns of the body are no slip: pressing arms lift much of the weight off the belly, and wind or
//! a push across rocks the body on its pads, by 0.8° for 1.5 N, and lets it back. The pipe then holds the arms: they
//! bend by as much on one side and unbend on the other, and their tips stay in place in the world. A sliding belly looks
//! the same at first, so the bending excuses some of a steady turn, and nothing of a fast one. A pair of arms resists
//! the rocking half as stiffly: twice as much is excused of a steady turn, and the excess over four arms of a fast one.

use crate::allocation::wrench::{PerArm, SIDE};
use crate::attitude::motion::Motion;
use crate::maths::filter::LowPass;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{clamp, deg, slew};

/// Turn since the grip was proven, or last tightened, that indicates a creep, rad, and the time for which it must last,
/// s: longer than a gust. Friction that fails slowly allows as much before it gives way (measured in the plant).
const CREEP: (f32, f32) = (deg(0.5), 0.5);
/// Rate at which that reference follows, rad/s: an accelerometer that drifts by 10 mg shows a turn of at most 0.6° in
/// minutes.
const DRIFT: f32 = deg(0.005);
/// Turn and outward rate, rad/s, that indicate a slip, and their time, s: a lean grows e-fold in 0.16 s once friction
/// gives way.
const SLIP: (f32, f32, f32) = (deg(1.0), 0.03, 0.03);
/// Steady turn excused by the opposite bending of four arms, rad: a push of 1.5 N in gusts. Fewer arms resist the
/// rocking less stiffly, and excuse more.
const ROCKS: f32 = deg(0.6);
/// Cut-off of the arms' bending, rad/s: suppresses their sensors' noise of 4 mrad, and settles well within the time of
/// a creep.
const BEND_CUTOFF: f32 = 10.0;
/// Least time between tightenings, s: the pressure follows its reference in 0.25 s.
pub const ANSWER_TIME: f32 = 0.3;

/// Slip detector, as described in the module header.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Slip {
    /// Reference of roll, pitch and bending, rad.
    from: Option<[f32; 3]>,
    /// Bending to the right, rad.
    bend: Option<LowPass>,
    /// Steady turn that bending excuses, rad.
    rocks: f32,
    creeps: HoldTimer,
    slips: HoldTimer,
    /// Time since the last tightening, s.
    since: f32,
    /// The body slips after the last tightening.
    helpless: bool,
}

impl Slip {
    /// One step of `dt` s with the arms' [`bending`], if known; true when the arms must tighten, provided that they
    /// `may`.
    pub fn step(&mut self, motion: Motion, bent: Option<Bent>, may: bool, dt: f32) -> bool {
        let (roll, pitch, _) = motion.q.to_euler();
        if let Some(Bent { right: bent, arms }) = bent {
            self.rocks = ROCKS * 4.0 / clamp(arms, 1.0, 4.0);
            let first = self.bend.is_none();
            let bend = self.bend.get_or_insert(LowPass::at(bent));
            bend.step(bent, BEND_CUTOFF, dt);
            self.from = self.from.filter(|_| !first);
        }
        let bend = self.bend.map_or(0.0, |bend| bend.value());
        let now = [roll, pitch, bend];
        let from = self.from.get_or_insert(now);
        for (from, now) in from.iter_mut().zip(now) {
            *from = slew(*from, now, DRIFT * dt);
        }
        let [rolled, nodded, bent] = [roll - from[0], pitch - from[1], bend - from[2]];
        let against = -bent * sign(rolled);
        let less = |most: f32| (rolled.abs() - clamp(against, 0.0, most)).max(nodded.abs());
        // Of a fast turn, bending excuses only the excess of a pair over four arms: 0 with four.
        let (stands, runs) = (less(self.rocks), less((self.rocks - ROCKS).max(0.0)));
        // Small angles: body rates approximate the rates of roll and pitch, well enough for a sign.
        let outward = if rolled.abs() > nodded.abs() {
            motion.rate.x * sign(rolled)
        } else {
            motion.rate.y * sign(nodded)
        };
        self.creeps.step(stands > CREEP.0, dt);
        self.slips.step(runs > SLIP.0 && outward > SLIP.1, dt);
        self.since = clamp(self.since + dt, 0.0, 1e3);
        let due = self.creeps.time() >= CREEP.1 || self.slips.time() >= SLIP.2;
        self.helpless = due && !may;
        let answers = due && may && self.since >= ANSWER_TIME;
        if answers {
            *self = Self {
                from: Some(now),
                bend: self.bend,
                rocks: self.rocks,
                ..Self::default()
            };
        }
        answers
    }

    /// The body keeps turning after the last tightening.
    pub fn helpless(&self) -> bool {
        self.helpless
    }
}

/// Bending of the arms that hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bent {
    /// Mean turn of their tips to the right, relative to the body, rad.
    right: f32,
    /// Number of these arms.
    arms: f32,
}

/// Bending of the `chosen` arms; `None` while a tilt is unknown.
pub fn bending(tilts: &PerArm<Option<f32>>, chosen: PerArm<bool>) -> Option<Bent> {
    let (mut sum, mut count) = (0.0, 0.0);
    for ((tilt, side), _) in tilts.iter().zip(SIDE).zip(chosen).filter(|(_, chosen)| *chosen) {
        sum += side * (*tilt)?;
        count += 1.0;
    }
    (count > 0.0).then(|| Bent {
        right: sum / count,
        arms: count,
    })
}

fn sign(x: f32) -> f32 {
    if x < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::vector::Quat;

    const DT: f32 = 0.01;

    /// Turns the body by `turn` ° within `time` s while the arms bend by `share` of it against it, then stands for 2 s; whether
    /// the arms were to tighten.
    fn answered(turn: f32, share: f32, time: f32) -> bool {
        answered_by([true; 4], turn, share, time)
    }

    /// With the `chosen` arms.
    fn answered_by(chosen: PerArm<bool>, turn: f32, share: f32, time: f32) -> bool {
        let mut slip = Slip::default();
        let steps = (time / DT) as u32;
        (0..steps + 300).fold(false, |answered, i| {
            // From a lean of 5° with arms that are bent unevenly, after a second at rest.
            let way = clamp((i as f32 - 100.0) / steps as f32, 0.0, 1.0);
            let rolls = if way > 0.0 && way < 1.0 {
                deg(turn) / time
            } else {
                0.0
            };
            let motion = Motion {
                q: Quat::from_euler(deg(5.0 + turn * way), 0.0, 0.0),
                rate: crate::maths::vector::Vec3::new(rolls, 0.0, 0.0),
                ..Motion::default()
            };
            let bent = deg(turn * share * way);
            let tilts = [-1.0 - bent, -1.3 - bent, -1.4 + bent, -1.1 + bent].map(Some);
            answered | slip.step(motion, bending(&tilts, chosen), true, DT)
        })
    }

    /// 1.5 N across, in wind: the plant's body leans by 0.7 to 0.8° within half a second, its arms bend by 0.7 to 1.2 of that.
    #[test]
    fn a_body_that_rocks_on_its_pads_does_not_slip() {
        for turn in [0.55, -0.55, 0.8, -0.8] {
            for share in [0.7, 1.2] {
                assert!(!answered(turn, share, 0.5), "{turn} deg, bent by {share}");
            }
        }
    }

    #[test]
    fn arms_that_turn_with_the_body_are_tightened() {
        assert!(!answered(0.4, 0.0, 0.5));
        for turn in [0.6, -0.6, 0.8, 2.0] {
            assert!(answered(turn, 0.0, 0.5), "{turn} deg");
            // Arms that bend with it, not against it, excuse nothing.
            assert!(answered(turn, -1.0, 0.5), "{turn} deg");
        }
    }

    #[test]
    fn bending_excuses_neither_a_large_turn_nor_one_that_runs() {
        assert!(answered(1.2, 1.0, 5.0));
        // 2.2 and 0.5 °/s at the end.
        assert!(answered(1.09, 1.0, 0.5) && !answered(1.09, 1.0, 2.0));
    }

    /// A push of 1.5 N in wind: the plant's body leans by 1.0 to 1.5° on a pair, at 2 to 8 °/s where the push begins, and the
    /// arms bend by 0.55 to 1.3 of it.
    #[test]
    fn a_pair_rocks_twice_as_far_and_slips_as_soon() {
        for pair in [[true, false, true, false], [false, true, false, true]] {
            for turn in [1.2, -1.2, 1.5, -1.5] {
                assert!(!answered_by(pair, turn, 1.0, 0.5), "{turn} deg");
                assert!(answered(turn, 1.0, 0.5), "{turn} deg on four");
            }
            // Arms that turn with the body, or bend with it, excuse nothing.
            for share in [0.0, -1.0] {
                assert!(!answered_by(pair, 0.4, share, 0.5));
                assert!(answered_by(pair, 0.6, share, 0.5) && answered_by(pair, -0.6, share, 0.5));
            }
            // Neither a turn of 1.9° that stands, nor one of 1.68° that runs: what is left is 0.7 and 1.08°.
            assert!(answered_by(pair, 1.9, 1.0, 5.0));
            assert!(answered_by(pair, 1.68, 1.0, 0.9) && !answered_by(pair, 1.68, 1.0, 5.0));
        }
    }

    #[test]
    fn arms_whose_tilt_is_unknown_excuse_nothing() {
        assert_eq!(bending(&[Some(0.1), None, Some(0.1), Some(0.1)], [true; 4]), None);
        let front = [true, false, true, false];
        let bent = bending(&[Some(-1.2), None, Some(-1.0), None], front);
        assert!(bent.is_some_and(|b| (b.right + 0.1).abs() < 1e-6 && (b.arms - 2.0).abs() < 1e-6));
        assert_eq!(bending(&[None; 4], [false; 4]), None);
    }
}
