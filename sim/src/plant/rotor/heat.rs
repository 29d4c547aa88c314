//! Thrust that a warm motor no longer gives: copper's resistance rises by 0.39 %/K, magnets weaken by 0.1 %/K.
//!
//! One thermal mass: ḣ = (p - h)/τ, p the power over that of half the largest thrust. The thrust falls by the share
//! `fade` at h = 1. Fades of 3 to 5 % are usual values; τ is assumed for a motor of 60 g.

/// Thermal time constant, s (assumed).
const TIME: f64 = 60.0;
/// Largest power over that of half the largest thrust that counts: 2^1.5 at full thrust.
const MOST: f64 = 3.0;

/// Heat of a motor.
#[derive(Clone, Copy, Debug)]
pub struct Heat {
    /// Share of thrust lost in long hover at half the largest thrust.
    fade: f64,
    warm: f64,
}

impl Heat {
    /// A cold motor that loses the share `fade` of its thrust in long hover.
    #[must_use]
    pub fn new(fade: f64) -> Self {
        Self { fade, warm: 0.0 }
    }

    /// Warms for `dt` s at `thrust` over half the largest; the power goes with its power of 1.5.
    pub fn step(&mut self, dt: f64, thrust: f64) {
        if self.fade > 0.0 {
            let power = (thrust * thrust.max(0.0).sqrt()).min(MOST);
            self.warm += (power - self.warm) * (dt / TIME);
        }
    }

    /// Factor on the thrust.
    #[must_use]
    pub fn factor(&self) -> f64 {
        1.0 - self.fade * self.warm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_hover_costs_the_stated_share_and_rest_gives_it_back() {
        let mut heat = Heat::new(0.04);
        for _ in 0..600 {
            heat.step(1.0, 1.0);
        }
        assert!((heat.factor() - 0.96).abs() < 1e-4);
        for _ in 0..600 {
            heat.step(1.0, 0.0);
        }
        assert!((heat.factor() - 1.0).abs() < 1e-4);
        let mut cold = Heat::new(0.0);
        cold.step(100.0, 2.0);
        assert_eq!(cold.factor(), 1.0);
    }
}
