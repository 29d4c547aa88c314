//! Closed forms of yaw, pitch and roll with arms that follow their thrust, in `f64`.

use sophie_control::allocation::arm_deflection::ArmModel;
use sophie_control::params::Params;
use sophie_sim::plant::contact::HINGE_Z;

/// One arm at work.
#[derive(Clone, Copy, Debug)]
pub struct AtThrust {
    /// sin α.
    pub sin: f64,
    /// cos α.
    pub cos: f64,
    /// T dα/dT, rad.
    pub follow: f64,
    b: f64,
    k_q: f64,
}

impl AtThrust {
    /// The default vehicle's arm at infill (%), gain K and thrust (N).
    pub fn new(infill: f64, gain_k: f64, thrust: f64) -> Self {
        let p = Params::default();
        let m = ArmModel::new(infill as f32, gain_k as f32, 0.5 * p.thrust_max);
        let (sin, cos) = f64::from(m.angle(thrust as f32)).sin_cos();
        let follow = thrust * f64::from(m.slope(thrust as f32));
        Self {
            sin,
            cos,
            follow,
            b: f64::from(p.arm_b),
            k_q: f64::from(p.torque_ratio),
        }
    }

    /// d(T sin α)/dT.
    fn lean(&self) -> f64 {
        self.sin + self.cos * self.follow
    }

    /// 1 - d(T cos α)/dT.
    fn lift_lost(&self) -> f64 {
        1.0 - (self.cos - self.sin * self.follow)
    }

    /// C_ψ = -χ (b/k_q) d(T sin α)/dT + 1 - d(T cos α)/dT; the last two terms are the drag's lean.
    pub fn yaw_derivative(&self, chi: f64) -> f64 {
        -chi * self.b / self.k_q * self.lean() + self.lift_lost()
    }

    /// C_θ = 1 - d(T cos α)/dT + χ (k_q/b) d(T sin α)/dT: lost lift, and the drag's lean about pitch.
    pub fn pitch_derivative(&self, chi: f64) -> f64 {
        self.lift_lost() + chi * self.k_q / self.b * self.lean()
    }

    /// C_φ = (z_h/d) d(T sin α)/dT: sideways thrust acts at the hinge, z_h below the centre of mass.
    pub fn roll_derivative(&self) -> f64 {
        HINGE_Z / f64::from(Params::default().arm_d) * self.lean()
    }

    /// Yaw authority over k_q at the frozen tilt: b sin α/k_q + χ.
    pub fn frozen(&self, chi: f64) -> f64 {
        self.b * self.sin / self.k_q + chi
    }

    /// Yaw authority over k_q with the arms following.
    pub fn quasi_static(&self, chi: f64) -> f64 {
        self.b * self.lean() / self.k_q + chi
    }

    /// Factor of a step of Algorithm 1 on a yaw pattern: -b T cos α dα/dT / (b sin α + χ k_q).
    pub fn one_step(&self, chi: f64) -> f64 {
        -self.b * self.cos * self.follow / (self.b * self.sin + chi * self.k_q)
    }
}

/// Smallest multiplier with a limit cycle of the frozen inverse, by Routh: with motor lag τ (s) and arm mode ω (rad/s),
/// ζ the loop (τs + 1)(s² + 2ζωs + ω²) + m ω² is unstable from (1 + 2ζωτ)(2ζω + ω²τ) = τω²(1 + m) on.
pub fn frozen_bound(tau: f64, omega: f64, zeta: f64) -> f64 {
    let damping = 2.0 * zeta * omega;
    (1.0 + damping * tau) * (damping + omega * omega * tau) / (tau * omega * omega) - 1.0
}

/// Zero of `f` from `low` to `high` by bisection; `None` without a change of sign.
pub fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> Option<f64> {
    let (start, end) = (f(low), f(high));
    if start * end > 0.0 || !start.is_finite() || !end.is_finite() {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if f(middle) * start > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    Some(0.5 * (low + high))
}

#[cfg(test)]
mod tests {
    use crate::paper::statics::*;

    #[test]
    fn b_is_stable_and_a_is_not_as_the_paper_says() {
        let c = |chi, infill, k| AtThrust::new(infill, k, 4.425).yaw_derivative(chi);
        for infill in [6.0, 6.9, 8.0, 10.0] {
            for k in [1.0, 5.03, 7.75, 8.4] {
                assert!(
                    c(1.0, infill, k) < 0.0 && c(-1.0, infill, k) > 0.0,
                    "{infill} {k}"
                );
            }
        }
        // A reverses only where C > 1; stiffer arms have a smaller derivative.
        assert!(c(-1.0, 6.9, 1.0) < 1.0 && c(-1.0, 6.9, 7.75) > 1.0);
        assert!(c(1.0, 6.0, 7.75) < c(1.0, 10.0, 7.75));
    }

    #[test]
    fn by_hand_at_the_default() {
        // α(4.425) = 7.75·(1.06077·0.275 - 0.05781·(4.425² - 4.15²)) = 1.204° = 0.02102 rad; slope 7.75·(1.06077 -
        // 0.11562·4.425) = 4.256 °/N = 0.07428 rad/N; d(T sin α)/dT = 0.02102 + 4.425·0.99978·0.07428 = 0.3496; times
        // b/k_q = 11.125: -3.889 for B; the drag's lean adds 0.007. Frozen bound 0.739 at 4.75 Hz, 50 ms, 0.15.
        let at = AtThrust::new(6.9, 7.75, 4.425);
        assert!((at.yaw_derivative(1.0) + 3.889).abs() < 0.01 && at.yaw_derivative(-1.0) > 0.0);
        assert!((frozen_bound(0.05, core::f64::consts::TAU * 4.75, 0.15) - 0.739).abs() < 0.002);
        let stiff = AtThrust::new(6.9, 1e-6, 4.425);
        assert!(stiff.yaw_derivative(1.0).abs() < 1e-5 && stiff.one_step(1.0).abs() < 1e-5);
        assert!((root(0.0, 3.0, |x| x * x - 2.0).unwrap() - 2f64.sqrt()).abs() < 1e-12);
    }
}
