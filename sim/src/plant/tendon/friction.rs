//! Friction of the thread in its channel.
//!
//! A thread that is drawn through a channel of the bend θ loses tension along it by the capstan equation, dT = −μ T dθ:
//! T_out = T_in exp(−μθ) while it slides towards the reel, T_in exp(μθ) while it slides back. Between the two bounds a
//! piece sticks, and its tension follows the arm's motion alone, as a spring of the thread's stiffness: a play in
//! tension, by return to the nearer bound. The channel has [`PIECES`] of equal bend, one behind the other, so that a reel
//! that turns back eases the thread from its entry on, and the tip last. Nothing chatters at rest. Bending is spread
//! evenly along the arm, and so is the moment that each piece puts on it: the arm bends by the pieces' mean tension,
//! T_in (1 − exp(−μθ))/(μθ) where all slide in.
//!
//! μ 0.1 to 0.3 lined with PTFE, 0.3 to 0.6 in TPU (handbooks); leaving it out costs 16.1 % of a tip's place against
//! 2.8 % (Matte and Kwok, JCISE 25(7) 071002), hysteresis after Palli and Melchiorri. μ = 0: none, T̄ = T_in.

/// Pieces of the channel.
const PIECES: usize = 8;

/// Thread in a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    coefficient: f64,
    /// Tension at the far end of each piece, N, from the entry on.
    ends: [f64; PIECES],
}

impl Friction {
    /// A slack thread in a channel with the friction `coefficient`.
    #[must_use]
    pub const fn new(coefficient: f64) -> Self {
        Self {
            coefficient,
            ends: [0.0; PIECES],
        }
    }

    /// Mean tension (N) along a channel of the bend `bend` (rad) under the tension `entry` (N) at its entry, after the
    /// arm's motion has stretched the thread by `stretched` N.
    pub fn step(&mut self, entry: f64, stretched: f64, bend: f64) -> f64 {
        if self.coefficient == 0.0 {
            return entry;
        }
        let loss = libm::exp(self.coefficient * bend.abs() / PIECES as f64);
        let (mut tension, mut sum) = (entry, 0.0);
        for end in &mut self.ends {
            *end = (*end + stretched).clamp(tension / loss, tension * loss);
            sum += 0.5 * (tension + *end);
            tension = *end;
        }
        sum / PIECES as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of the capstan's tension over a bend, (1 - exp(-a))/a.
    fn capstan(a: f64) -> f64 {
        (1.0 - libm::exp(-a)) / a
    }

    #[test]
    fn a_sliding_thread_has_the_capstan_s_mean_tension() {
        let mut thread = Friction::new(0.4);
        let winding = thread.step(36.0, 0.0, -1.2);
        assert!((winding / 36.0 - capstan(0.48)).abs() < 5e-4, "{winding}");
        let at_tip = thread.ends[PIECES - 1];
        assert!((at_tip - 36.0 * libm::exp(-0.48_f64)).abs() < 1e-9, "{at_tip}");
        let releasing = thread.step(10.0, 0.0, -1.2);
        assert!((releasing / 10.0 - capstan(-0.48)).abs() < 5e-4, "{releasing}");
        // A straight channel has none, and a slack thread pulls nothing.
        assert_eq!(thread.step(10.0, 0.0, 0.0), 10.0);
        assert_eq!(thread.step(0.0, 0.0, -1.2), 0.0);
    }

    #[test]
    fn a_reel_that_turns_back_eases_the_thread_from_its_entry_on() {
        // The entry falls from 1 to t: up to μφ = ln(1/t)/2 it is t exp(μφ), beyond as it was.
        for (entry, mean) in [(0.8_f64, 0.7704), (0.65, 0.7154), (0.5, 0.6151), (0.3829, 0.4914)] {
            let turned = (-libm::log(entry) / 2.0).min(0.48);
            let eased = entry * (libm::exp(turned) - 1.0) + libm::exp(-turned) - libm::exp(-0.48_f64);
            assert!((eased / 0.48 - mean).abs() < 1e-3, "{entry}: {}", eased / 0.48);
            let mut thread = Friction::new(0.4);
            thread.step(1.0, 0.0, -1.2);
            let found = thread.step(entry, 0.0, -1.2);
            assert!((found - mean).abs() < 5e-3, "{entry}: {found}");
        }
    }

    #[test]
    fn motions_to_and_fro_within_the_stick_zone_do_not_ratchet() {
        let mut thread = Friction::new(0.4);
        thread.step(36.0, 0.0, -1.0);
        let wound = thread.step(36.0, 0.0, -1.0);
        for _ in 0..1000 {
            thread.step(35.0, 0.0, -1.0);
            thread.step(36.0, 0.0, -1.0);
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
