//! Limits of every allocation: rotor range, least thrust for yaw, share of yaw.

use crate::allocation::desaturation::{Given, desaturate};
use crate::allocation::least_thrust::least_thrust;
use crate::allocation::mixer::{Mix, Split};
use crate::allocation::wrench::PerArm;
use crate::maths::scalar;
use crate::params::Params;

/// Hysteresis of the yaw gate, N.
const GATE_HYSTERESIS: f32 = 0.2;

/// Rotor limits and yaw gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    idle: f32,
    max: f32,
    yaw_limit: f32,
    gate: f32,
    yaw_open: bool,
}

impl Limits {
    /// From the parameters, with the yaw gate shut.
    pub fn new(p: &Params) -> Self {
        Self {
            idle: least_thrust(p),
            max: p.thrust_max,
            yaw_limit: p.yaw_thrust_max,
            gate: p.yaw_gate_thrust,
            yaw_open: false,
        }
    }

    /// Rotors at idle.
    pub const fn at_idle(&self) -> Mix {
        Mix {
            thrusts: [self.idle; 4],
            given: Given::ALL,
            yaw_gated: true,
        }
    }

    /// Root of the largest thrust over that of the parameters, within 0.5..1.25: by half again stronger rotors at most.
    #[inline(always)]
    pub fn thrust_ratio(ratio: f32) -> f32 {
        scalar::clamp(ratio, 0.5, 1.25)
    }

    /// Updates the yaw gate by the low-passed thrusts (N); true if yaw may be used.
    #[inline(always)]
    pub fn open_yaw(&mut self, thrusts: PerArm<f32>) -> bool {
        let [t1, t2, t3, t4] = thrusts;
        let mean = 0.25 * ((t1 + t2) + (t3 + t4));
        let shut = if self.yaw_open { 0.0 } else { GATE_HYSTERESIS };
        self.yaw_open = mean >= self.gate + shut;
        self.yaw_open
    }

    /// Thrusts of `split` within the limits at a thrust ratio, yaw only if `usable`.
    #[inline(always)]
    pub fn give(&self, split: Split, usable: bool, ratio: f32) -> Mix {
        let high = self.max * ratio * ratio;
        let Split { mut patterns, fade } = split;
        let share = self.yaw_share(&patterns.yaw, if usable { fade } else { 0.0 });
        patterns.yaw = patterns.yaw.map(|y| y * share);
        let (thrusts, mut given) = desaturate(&patterns, self.idle, high);
        given.yaw *= share;
        Mix {
            thrusts,
            given,
            yaw_gated: share <= 0.0,
        }
    }

    /// Share of a yaw pattern within a rotor's allowance, at most `fade`.
    #[inline(always)]
    fn yaw_share(&self, yaw: &PerArm<f32>, fade: f32) -> f32 {
        let larger = |a: f32, b: f32| if a > b { a } else { b };
        let [a, b, c, d] = yaw.map(f32::abs);
        let worst = larger(larger(a, b), larger(c, d));
        let limited = self.yaw_limit / worst;
        if worst * fade > self.yaw_limit {
            limited
        } else {
            fade
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rotor_that_yaw_moves_most_sets_its_share_whichever_it_is() {
        let limits = Limits::new(&Params::default());
        // 1.5 N of 3 N are allowed: a half. 1.2 N are within it: only the fade acts.
        for worst in 0..4 {
            for sign in [1.0, -1.0] {
                let mut yaw = [0.5, -1.0, 0.25, -2.0];
                yaw[worst] = 3.0 * sign;
                assert!(
                    limits.yaw_share(&yaw, 1.0) == 0.5 && limits.yaw_share(&yaw, 0.51) == 0.5,
                    "{yaw:?}"
                );
                assert!(limits.yaw_share(&yaw, 0.4) == 0.4, "{yaw:?}");
            }
        }
        assert!(limits.yaw_share(&[0.0; 4], 1.0) == 1.0 && limits.yaw_share(&[0.0; 4], 0.3) == 0.3);
    }

    #[test]
    fn the_yaw_gate_opens_a_fifth_of_a_newton_above_where_it_shuts() {
        let mut limits = Limits::new(&Params::default());
        let gate = Params::default().yaw_gate_thrust;
        let mut open = |mean: f32| limits.open_yaw([mean - 1.0, mean + 1.0, mean, mean]);
        assert!(!open(gate + 0.19) && open(gate + 0.21) && open(gate + 0.01) && !open(gate - 0.01));
    }
}
