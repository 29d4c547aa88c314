//! Creep by decades of time: under a constant load the strain grows by an equal share in each tenfold of time.
//!
//! A linear solid with retardation times a decade apart: e = Σ eᵢ, deᵢ/dt = (c x − eᵢ)/τᵢ, τᵢ = 10^0.75 τ0 · 10^i.
//! Under a constant load x it follows c x log10(1 + t/τ0) within 0.13 c x up to the last time, 10^5.75 τ0; a relieved
//! part recovers as slowly as it crept. c = 0: none.

/// Retardation times.
const TIMES: usize = 6;
/// First retardation time over τ0: Σ(1 − exp(−t/τᵢ)) tends to log10(t/τ0), by the sum's γ/ln 10 + 1/2.
const FIRST: f64 = 5.623;

/// A creeping part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Creep {
    /// Share of the load's strain per decade.
    share: f64,
    /// τ0, s.
    begin: f64,
    crept: [f64; TIMES],
}

impl Creep {
    /// A part without load so far, with the `share` of its strain per decade, counted from `begin` s.
    #[must_use]
    pub const fn new(share: f64, begin: f64) -> Self {
        Self {
            share,
            begin,
            crept: [0.0; TIMES],
        }
    }

    /// Creep `dt` s later, with `strain` under the present load, in the strain's unit.
    pub fn step(&mut self, dt: f64, strain: f64) -> f64 {
        if self.share == 0.0 {
            return 0.0;
        }
        let mut time = FIRST * self.begin;
        let mut sum = 0.0;
        for crept in &mut self.crept {
            // Implicit: stable for any step.
            let rate = dt / time;
            *crept = (*crept + rate * self.share * strain) / (1.0 + rate);
            sum += *crept;
            time *= 10.0;
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_load_creeps_by_its_share_in_each_decade() {
        let mut part = Creep::new(0.04, 1.0);
        let (mut t, dt) = (0.0, 0.05);
        for decade in [1.0, 10.0, 100.0, 1e3, 1e4] {
            let mut crept = 0.0;
            while t < decade {
                crept = part.step(dt, 5.0);
                t += dt;
            }
            let law = 0.04 * 5.0 * libm::log10(1.0 + t);
            assert!((crept - law).abs() < 0.13 * 0.04 * 5.0, "{t}: {crept} {law}");
        }
        // An hour after the load has left, most of what crept in three hours is back.
        let crept = part.step(dt, 5.0);
        let left = (0..72_000).fold(0.0, |_, _| part.step(dt, 0.0));
        assert!(left > 0.02 * crept && left < 0.4 * crept, "{left} of {crept}");
    }

    #[test]
    fn without_a_share_nothing_creeps() {
        assert_eq!(Creep::new(0.0, 1.0).step(100.0, 5.0), 0.0);
    }
}
