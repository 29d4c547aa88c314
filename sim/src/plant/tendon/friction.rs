//! Friction of the thread in its channel.
//!
//! A thread that is drawn through a channel of the bend θ loses tension along it by the capstan equation, dT = −μ T dθ:
//! T_out = T_in exp(−μθ) while it slides towards the reel, T_in exp(μθ) while it slides back. Bending is spread evenly
//! along the arm, and so is the moment that each piece of the thread puts on it: the arm bends by the mean tension
//! T̄ = T_in m(μθ) or T_in m(−μθ), m(a) = (1 − exp(−a))/a. Between the two bounds the thread sticks: T̄ then follows
//! the arm's own motion alone, as a spring of the thread's stiffness, whatever the reel does (a play in tension, by
//! return to the nearest bound). So nothing chatters at rest, and a reel that turns back eases the arm only after it
//! has given up the friction of both ways.
//!
//! μ 0.1 to 0.3 lined with PTFE, 0.3 to 0.6 in TPU (handbooks); leaving it out costs 16.1 % of a tip's place against
//! 2.8 % (Matte and Kwok, JCISE 25(7) 071002), hysteresis after Palli and Melchiorri. μ = 0: none, T̄ = T_in.

/// Thread in a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    coefficient: f64,
    /// Mean tension along the channel, N.
    mean: f64,
}

impl Friction {
    /// A slack thread in a channel with the friction `coefficient`.
    #[must_use]
    pub const fn new(coefficient: f64) -> Self {
        Self {
            coefficient,
            mean: 0.0,
        }
    }

    /// Mean tension (N) along a channel of the bend `bend` (rad) under the tension `entry` (N) at its entry, after the
    /// arm's motion has stretched the thread by `stretched` N.
    pub fn step(&mut self, entry: f64, stretched: f64, bend: f64) -> f64 {
        if self.coefficient == 0.0 {
            return entry;
        }
        let a = self.coefficient * bend.abs();
        self.mean = (self.mean + stretched).clamp(entry * mean(a), entry * mean(-a));
        self.mean
    }
}

/// Mean tension over the tension at the entry, with the exponent `a` of the capstan's equation.
fn mean(a: f64) -> f64 {
    // The series of the quotient where it loses digits.
    if a.abs() < 1e-4 {
        1.0 - 0.5 * a
    } else {
        (1.0 - libm::exp(-a)) / a
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of the capstan's tension over the bend, in small pieces.
    fn pieces(a: f64) -> f64 {
        let pieces = 10_000;
        let at = |i: i32| libm::exp(-a * (f64::from(i) + 0.5) / f64::from(pieces));
        (0..pieces).map(at).sum::<f64>() / f64::from(pieces)
    }

    #[test]
    fn a_sliding_thread_has_the_capstan_s_mean_tension() {
        let mut thread = Friction::new(0.4);
        let winding = thread.step(36.0, 0.0, -1.2);
        assert!((winding - 36.0 * pieces(0.48)).abs() < 1e-5, "{winding}");
        let releasing = thread.step(10.0, 0.0, -1.2);
        assert!((releasing - 10.0 * pieces(-0.48)).abs() < 1e-5, "{releasing}");
        // A straight channel has none, and a slack thread pulls nothing.
        assert_eq!(thread.step(10.0, 0.0, 0.0), 10.0);
        assert_eq!(thread.step(0.0, 0.0, -1.2), 0.0);
    }

    #[test]
    fn a_reel_that_turns_back_eases_the_arm_only_beyond_the_stick_zone() {
        let mut thread = Friction::new(0.4);
        let wound = thread.step(36.0, 0.0, -1.0);
        let bounds = (pieces(0.4), pieces(-0.4));
        let free = 36.0 * bounds.0 / bounds.1;
        assert_eq!(thread.step(1.01 * free, 0.0, -1.0), wound);
        assert!(thread.step(0.9 * free, 0.0, -1.0) < 0.95 * wound);
        // To and fro within the zone ends where it began: no ratchet.
        let mut thread = Friction::new(0.4);
        thread.step(36.0, 0.0, -1.0);
        for _ in 0..1000 {
            thread.step(34.0, 0.5, -1.0);
            thread.step(36.0, -0.5, -1.0);
        }
        assert!((thread.step(36.0, 0.0, -1.0) - wound).abs() < 1e-9);
    }

    #[test]
    fn friction_takes_work_from_every_turn() {
        // Bent by 0.3 rad and back under 36 N at the entry: the arm gets less than it gives.
        let (mut thread, lever, stiffness, mut work) = (Friction::new(0.3), 0.015, 8000.0, 0.0);
        for _ in 0..3 {
            work = 0.0;
            for step in 0..600 {
                let change: f64 = if step < 300 { 1e-3 } else { -1e-3 };
                let bend = 0.8 + 1e-3 * f64::from(if step < 300 { step } else { 600 - step });
                work += thread.step(36.0, -stiffness * lever * change, bend) * lever * change;
            }
        }
        // At most twice 36 N · 0.14 over 4.5 mm of way, less the stick zones.
        assert!((-0.0455..-0.025).contains(&work), "{work}");
    }

    #[test]
    fn without_friction_the_tension_is_the_same_everywhere() {
        assert_eq!(Friction::new(0.0).step(36.0, 5.0, -1.2), 36.0);
    }
}
