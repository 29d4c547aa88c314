//! What to give up when the rotors cannot do it all: yaw first, then thrust, roll and pitch last.

use crate::math;
use crate::wrench::PerArm;

/// What the rotors could give of a demand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Share of the roll and pitch moments, 0..1.
    pub roll_pitch: f32,
    /// Collective thrust added (positive) or taken off to keep roll and pitch, N.
    pub thrust_shift: f32,
    /// Share of the yaw moment, 0..1.
    pub yaw: f32,
}

impl Given {
    /// All that was asked.
    pub const ALL: Self = Self {
        roll_pitch: 1.0,
        thrust_shift: 0.0,
        yaw: 1.0,
    };

    /// True when something was given up.
    pub fn saturated(&self) -> bool {
        self.roll_pitch < 1.0 || self.yaw < 1.0 || self.thrust_shift > 0.01 || self.thrust_shift < -0.01
    }
}

impl Default for Given {
    fn default() -> Self {
        Self::ALL
    }
}

/// A demand split into the patterns that may be given up one after the other, N for each rotor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Patterns {
    /// Thrusts of the collective alone.
    pub collective: PerArm<f32>,
    /// Change of the thrusts for one newton more of collective.
    pub shift: PerArm<f32>,
    /// Roll and pitch.
    pub roll_pitch: PerArm<f32>,
    /// Yaw.
    pub yaw: PerArm<f32>,
}

/// Thrusts within [`low`, `high`] N that come nearest to the demand, and what was given up for it.
pub fn desaturate(p: &Patterns, low: f32, high: f32) -> (PerArm<f32>, Given) {
    // A rotor that thrust does not reach cannot bound the shift; the least entry keeps divisions finite.
    const LEAST_SHIFT: f32 = 0.02;
    let inv_shift = p.shift.map(|s| 1.0 / math::clamp(s, LEAST_SHIFT, 10.0));

    // Roll and pitch: the largest share for which some collective fits all four rotors, that is, for which
    // every rotor's lower bound on the collective shift stays under every other's upper bound.
    let mut share = 1.0f32;
    for ((c_i, r_i), k_i) in p.collective.iter().zip(&p.roll_pitch).zip(&inv_shift) {
        for ((c_j, r_j), k_j) in p.collective.iter().zip(&p.roll_pitch).zip(&inv_shift) {
            let room = (high - c_j) * k_j - (low - c_i) * k_i;
            let need = r_j * k_j - r_i * k_i;
            if need > 0.0 && need * share > room {
                share = math::clamp(room / need, 0.0, share);
            }
        }
    }

    // Thrust: the smallest shift that makes them fit.
    let (mut least, mut most) = (f32::MIN, f32::MAX);
    for ((c, r), k) in p.collective.iter().zip(&p.roll_pitch).zip(&inv_shift) {
        let x = c + share * r;
        let (lower, upper) = ((low - x) * k, (high - x) * k);
        least = if lower > least { lower } else { least };
        most = if upper < most { upper } else { most };
    }
    let shift = if least > 0.0 {
        least
    } else if most < 0.0 {
        most
    } else {
        0.0
    };

    // Yaw: whatever room is left.
    let mut yaw = 1.0f32;
    let mut thrusts = p.collective;
    for ((t, r), (s, y)) in thrusts
        .iter_mut()
        .zip(&p.roll_pitch)
        .zip(p.shift.iter().zip(&p.yaw))
    {
        *t += share * r + shift * s;
        let room = if *y > 0.0 { high - *t } else { *t - low };
        let need = if *y > 0.0 { *y } else { -*y };
        if need * yaw > room {
            yaw = math::clamp(room / need, 0.0, yaw);
        }
    }
    for (t, y) in thrusts.iter_mut().zip(&p.yaw) {
        *t = math::clamp(*t + yaw * y, low, high);
    }
    (
        thrusts,
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
    use crate::wrench::{FORE, SIDE, YAW};

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
        // 6 + 3 = 9: 0.7 N too much, taken off every rotor (2.8 N of collective).
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
            // Roll and pitch actually given have the share that is reported.
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
