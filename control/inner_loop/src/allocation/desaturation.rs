//! Saturated rotors give up yaw first, then thrust, roll and pitch last.
//!
//! 1 kHz, thrusts in N.

use crate::allocation::wrench::PerArm;
use crate::maths::scalar;

/// Feasible part of a demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Share of the roll and pitch moments, 0..1.
    pub roll_pitch: f32,
    /// Collective added (positive) or removed to keep roll and pitch, N.
    pub thrust_shift: f32,
    /// Share of the yaw moment, 0..1.
    pub yaw: f32,
}

impl Given {
    /// The whole demand.
    pub const ALL: Self = Self {
        roll_pitch: 1.0,
        thrust_shift: 0.0,
        yaw: 1.0,
    };

    /// True if something was given up.
    pub fn saturated(&self) -> bool {
        self.roll_pitch < 1.0 || self.yaw < 1.0 || self.thrust_shift > 0.01 || self.thrust_shift < -0.01
    }
}

impl Default for Given {
    fn default() -> Self {
        Self::ALL
    }
}

/// A demand split into patterns to be given up in turn, N per rotor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Patterns {
    /// Collective alone.
    pub collective: PerArm<f32>,
    /// Change per newton of collective.
    pub shift: PerArm<f32>,
    /// Roll and pitch.
    pub roll_pitch: PerArm<f32>,
    /// Yaw.
    pub yaw: PerArm<f32>,
}

/// Least thrust of a rotor per newton of collective: one beyond the collective's reach cannot bound the shift, and
/// divisions stay finite.
const LEAST_SHIFT: f32 = 0.02;

/// A share as fraction: one division at the end serves all bounds.
#[derive(Clone, Copy)]
struct Share {
    room: f32,
    need: f32,
}

impl Share {
    const ALL: Self = Self { room: 1.0, need: 1.0 };

    /// At most `room` / `need`, need >= 0.
    #[inline(always)]
    fn within(self, room: f32, need: f32) -> Self {
        let tighter = room * self.need < self.room * need;
        Self {
            room: if tighter { room } else { self.room },
            need: if tighter { need } else { self.need },
        }
    }

    #[inline(always)]
    fn value(self) -> f32 {
        scalar::clamp(self.room / self.need, 0.0, 1.0)
    }
}

/// Bounds of one rotor on the collective shift: `lower` to `upper` without roll and pitch, `slope` lower with all of
/// them.
#[derive(Clone, Copy)]
struct Bounds {
    lower: f32,
    upper: f32,
    slope: f32,
}

impl Share {
    /// Keeps each rotor's lower bound under the other's upper one.
    #[inline(always)]
    fn agreed(self, i: &Bounds, j: &Bounds) -> Self {
        let need = j.slope - i.slope;
        let (forth, back) = (j.upper - i.lower, i.upper - j.lower);
        self.within(if need > 0.0 { forth } else { back }, need.abs())
    }
}

/// Thrusts within [`low`, `high`] N nearest to the demand, and the shares given. No branch depends on the demand.
#[inline(always)]
pub fn desaturate(p: &Patterns, low: f32, high: f32) -> (PerArm<f32>, Given) {
    let bounds = |collective: f32, shift: f32, roll_pitch: f32| {
        let per_shift = 1.0 / if shift > LEAST_SHIFT { shift } else { LEAST_SHIFT };
        Bounds {
            lower: (low - collective) * per_shift,
            upper: (high - collective) * per_shift,
            slope: roll_pitch * per_shift,
        }
    };
    let ([c1, c2, c3, c4], [s1, s2, s3, s4]) = (p.collective, p.shift);
    let ([r1, r2, r3, r4], [y1, y2, y3, y4]) = (p.roll_pitch, p.yaw);
    let (b1, b2) = (bounds(c1, s1, r1), bounds(c2, s2, r2));
    let (b3, b4) = (bounds(c3, s3, r3), bounds(c4, s4, r4));

    // Roll and pitch: the largest share for which one collective fits all four rotors, each lower bound on the shift
    // below every other rotor's upper one.
    let share = Share::ALL
        .agreed(&b1, &b2)
        .agreed(&b1, &b3)
        .agreed(&b1, &b4)
        .agreed(&b2, &b3)
        .agreed(&b2, &b4)
        .agreed(&b3, &b4)
        .value();

    // Thrust: the smallest shift that fits.
    let larger = |a: f32, b: f32| if a > b { a } else { b };
    let smaller = |a: f32, b: f32| if a < b { a } else { b };
    let lower = |b: Bounds| b.lower - share * b.slope;
    let upper = |b: Bounds| b.upper - share * b.slope;
    let least = larger(larger(lower(b1), lower(b2)), larger(lower(b3), lower(b4)));
    let most = smaller(smaller(upper(b1), upper(b2)), smaller(upper(b3), upper(b4)));
    let shift = larger(least, smaller(most, 0.0));

    // Yaw: the room that is left.
    let (t1, t2) = (c1 + share * r1 + shift * s1, c2 + share * r2 + shift * s2);
    let (t3, t4) = (c3 + share * r3 + shift * s3, c4 + share * r4 + shift * s4);
    let room = |t: f32, y: f32| if y > 0.0 { high - t } else { t - low };
    let yaw = Share::ALL
        .within(room(t1, y1), y1.abs())
        .within(room(t2, y2), y2.abs())
        .within(room(t3, y3), y3.abs())
        .within(room(t4, y4), y4.abs())
        .value();
    let thrust = |t: f32, y: f32| scalar::clamp(t + yaw * y, low, high);
    (
        [thrust(t1, y1), thrust(t2, y2), thrust(t3, y3), thrust(t4, y4)],
        Given {
            roll_pitch: share,
            thrust_shift: shift,
            yaw,
        },
    )
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::allocation::wrench::{FORE, SIDE, YAW};

    const LOW: f32 = 0.25;
    const HIGH: f32 = 8.3;

    fn patterns(collective: f32, roll: f32, pitch: f32, yaw: f32) -> Patterns {
        let mut p = Patterns {
            collective: [collective; 4],
            shift: [0.25; 4],
            ..Patterns::default()
        };
        for i in 0..4 {
            p.roll_pitch[i] = SIDE[i] * roll + FORE[i] * pitch;
            p.yaw[i] = YAW[i] * yaw;
        }
        p
    }

    #[test]
    fn what_fits_is_left_alone() {
        let (t, g) = desaturate(&patterns(4.4, 1.0, 0.5, 0.3), LOW, HIGH);
        assert!(g == Given::ALL && !g.saturated());
        assert!((t[0] - 6.2).abs() < 1e-5 && (t[3] - 3.2).abs() < 1e-5);
    }

    #[test]
    fn yaw_goes_first() {
        // 4.4 + 3.5 = 7.9 leaves 0.4 N of 1 N for yaw.
        let (t, g) = desaturate(&patterns(4.4, 3.5, 0.0, 1.0), LOW, HIGH);
        assert!((g.yaw - 0.4).abs() < 1e-5 && g.roll_pitch == 1.0 && g.thrust_shift == 0.0);
        assert!((t[0] - 8.3).abs() < 1e-5);
    }

    #[test]
    fn then_thrust_then_roll_and_pitch() {
        // 6 + 3 = 9: 0.7 N too much, removed from every rotor (2.8 N of collective).
        let (_, g) = desaturate(&patterns(6.0, 3.0, 0.0, 1.0), LOW, HIGH);
        assert!((g.thrust_shift + 2.8).abs() < 1e-4 && g.roll_pitch == 1.0 && g.yaw == 0.0);
        // A spread of 10 N cannot fit into 8.05.
        let (t, g) = desaturate(&patterns(6.0, 5.0, 0.0, 1.0), LOW, HIGH);
        assert!((g.roll_pitch - 0.805).abs() < 1e-4);
        assert!((t[0] - HIGH).abs() < 1e-4 && (t[2] - LOW).abs() < 1e-4);
    }

    proptest! {
        #[test]
        fn always_within_the_limits_and_never_reversed(
            c in -5.0f32..15.0, r in -20.0f32..20.0, p in -20.0f32..20.0, y in -5.0f32..5.0,
        ) {
            let (t, g) = desaturate(&patterns(c, r, p, y), LOW, HIGH);
            prop_assert!(t.iter().all(|t| (LOW..=HIGH).contains(t)));
            prop_assert!((0.0..=1.0).contains(&g.roll_pitch) && (0.0..=1.0).contains(&g.yaw));
            let roll = 0.25 * (t[0] + t[1] - t[2] - t[3]);
            let pitch = 0.25 * (t[0] - t[1] + t[2] - t[3]);
            prop_assert!((roll - g.roll_pitch * r).abs() < 2e-3 && (pitch - g.roll_pitch * p).abs() < 2e-3);
        }

        #[test]
        fn asking_for_more_yaw_never_costs_roll_pitch_or_thrust(
            c in 0.0f32..9.0, r in -6.0f32..6.0, y in 0.0f32..5.0,
        ) {
            let (_, without) = desaturate(&patterns(c, r, 0.0, 0.0), LOW, HIGH);
            let (_, with) = desaturate(&patterns(c, r, 0.0, y), LOW, HIGH);
            prop_assert!(with.roll_pitch == without.roll_pitch && with.thrust_shift == without.thrust_shift);
        }

        #[test]
        fn more_demand_never_gives_a_smaller_moment(c in 0.0f32..9.0, r in 0.0f32..6.0, more in 0.0f32..3.0) {
            let given = |r: f32| desaturate(&patterns(c, r, 0.0, 0.0), LOW, HIGH).1.roll_pitch * r;
            prop_assert!(given(r + more) >= given(r) - 1e-3);
        }

        #[test]
        fn no_nan_comes_out(bits in prop::array::uniform16(any::<u32>())) {
            let f = |i: usize| core::array::from_fn(|k| f32::from_bits(bits[4 * i + k]));
            let p = Patterns { collective: f(0), shift: f(1), roll_pitch: f(2), yaw: f(3) };
            let (t, _) = desaturate(&p, LOW, HIGH);
            prop_assert!(t.iter().all(|t| (LOW..=HIGH).contains(t)));
        }
    }
}
