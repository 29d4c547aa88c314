//! Friction of the thread in its channel.
//!
//! A thread that is drawn through a channel of the bend θ loses tension along it by the capstan equation, dT = −μ T dθ:
//! T_out = T_in exp(−μθ) while it slides towards the reel, T_in exp(μθ) while it slides back. A thread at rest holds
//! anything between the two: z, −1 to 1, is the share of the friction that is mobilised, an elastic-plastic play of
//! ±[`PRESLIDING`] of the thread's motion, so that nothing chatters at rest. Bending is spread evenly along the arm, and
//! so is the moment that each piece of the thread puts on it: the arm bends by the mean tension,
//! T_in (1 − exp(−a))/a, a = z μ θ.
//!
//! μ 0.1 to 0.3 lined with PTFE, 0.3 to 0.6 in TPU (handbooks); leaving it out costs 16.1 % of a tip's place against 2.8
//! % (Matte and Kwok, JCISE 25(7) 071002), hysteresis after Palli and Melchiorri. μ = 0: none, T_out = T_in.

/// Motion from full friction one way to none, m: the thread's own stretch under 5 N of friction (assumed).
const PRESLIDING: f64 = 0.3e-3;

/// Thread in a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    coefficient: f64,
    /// Share of the friction that is mobilised: 1 while the thread slides towards the reel.
    mobilised: f64,
}

impl Friction {
    /// A thread at rest in a channel with the friction `coefficient`.
    #[must_use]
    pub const fn new(coefficient: f64) -> Self {
        Self {
            coefficient,
            mobilised: 0.0,
        }
    }

    /// Mean tension along a channel of the bend `bend` (rad) over the tension at its entry, after a motion of `slid` m,
    /// towards the reel positive.
    pub fn step(&mut self, slid: f64, bend: f64) -> f64 {
        if self.coefficient == 0.0 {
            return 1.0;
        }
        self.mobilised = (self.mobilised + slid / PRESLIDING).clamp(-1.0, 1.0);
        let a = self.mobilised * self.coefficient * bend.abs();
        // The series of the quotient where it loses digits.
        if a.abs() < 1e-4 {
            1.0 - 0.5 * a
        } else {
            (1.0 - libm::exp(-a)) / a
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of the capstan's tension over the bend, in small pieces.
    fn mean(a: f64) -> f64 {
        let pieces = 10_000;
        (0..pieces)
            .map(|i| libm::exp(-a * (f64::from(i) + 0.5) / f64::from(pieces)))
            .sum::<f64>()
            / f64::from(pieces)
    }

    #[test]
    fn a_sliding_thread_has_the_capstan_s_mean_tension() {
        let mut thread = Friction::new(0.4);
        let winding = thread.step(1e-3, -1.2);
        assert!((winding - mean(0.48)).abs() < 1e-6 && winding < 0.8, "{winding}");
        let releasing = thread.step(-1e-3, -1.2);
        assert!(
            (releasing - mean(-0.48)).abs() < 1e-6 && releasing > 1.2,
            "{releasing}"
        );
        // A straight channel has none.
        assert!((thread.step(0.0, 0.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_thread_at_rest_keeps_its_friction_and_sticks_on_the_way_back() {
        let mut thread = Friction::new(0.4);
        let wound = thread.step(1e-3, -1.0);
        assert_eq!(thread.step(0.0, -1.0), wound);
        let back = |slid: f64| {
            let mut copy = thread;
            copy.step(slid, -1.0)
        };
        assert!((back(-PRESLIDING) - 1.0).abs() < 1e-9);
        assert!(back(-0.5 * PRESLIDING) > wound && back(-0.5 * PRESLIDING) < 1.0);
        // A small motion to and fro ends where it began: no ratchet.
        for _ in 0..1000 {
            thread.step(-1e-5, -1.0);
            thread.step(1e-5, -1.0);
        }
        assert!((thread.step(0.0, -1.0) - wound).abs() < 1e-9);
    }

    #[test]
    fn friction_takes_work_from_every_turn() {
        // Bent by 0.3 rad and back under 36 N at the entry: the arm gets less than it gives.
        let (mut thread, lever, mut work) = (Friction::new(0.3), 0.015, 0.0);
        for turn in 0..3 {
            work = 0.0;
            for step in 0..600 {
                let change: f64 = if step < 300 { 1e-3 } else { -1e-3 };
                let bend = 0.8 + 1e-3 * f64::from(if step < 300 { step } else { 600 - step });
                work += 36.0 * thread.step(lever * change, bend) * lever * change;
            }
            assert!(turn == 0 || work < 0.0, "{work}");
        }
        // Twice the friction over the way, less the stick zone: 2 · 36 N · 0.14 · 4.5 mm.
        assert!((-0.05..-0.03).contains(&work), "{work}");
    }

    #[test]
    fn without_friction_the_tension_is_the_same_everywhere() {
        assert_eq!(Friction::new(0.0).step(1e-3, -1.2), 1.0);
    }
}
