//! Rebound of an elastic pad: Hunt and Crossley's damping (1975), F = k x (1 + λ ẋ) with ẋ > 0 into the surface.
//!
//! Its force begins and ends at zero, without a step and without adhesion. A mass m that arrives at v: m v dv = -k x (1 +
//! λ v) dx. With u = λ v the way in and the way out reach the same depth where
//!
//! u₀ - ln(1 + u₀) = -e u₀ - ln(1 - e u₀),
//!
//! so u₀ depends on the restitution e alone, not on k and m: λ = u₀ / v for the speed v of this touch makes e the same at
//! every speed. Small losses: u₀ = 3 (1 - e) / 2.
//!
//! Printed TPU has loss factors of 0.1 to 0.3, damping ratios of 0.05 to 0.13: e 0.65 to 0.75 (Covestro Texin 245:
//! resilience 45 %, e = √0.45 = 0.67; foamed 65 to 74 %).

/// Slowest touch that λ is made for, m/s: slower ones rebound by less than 0.5 mm.
const SLOWEST: f64 = 0.1;
/// Bisections of u₀, below 1e-12 of it.
const BISECTIONS: u32 = 60;

/// u₀ of a coefficient of restitution between 0 and 1, exclusive; 0 of 0 and below, which have no such damping.
#[must_use]
pub fn rebound(restitution: f64) -> f64 {
    let e = restitution;
    if e <= 0.0 {
        return 0.0;
    }
    // Between nothing and the way out's limit, e u₀ = 1.
    let (mut low, mut high) = (0.0, 1.0 / e);
    for _ in 0..BISECTIONS {
        let u = 0.5 * (low + high);
        let (inward, outward) = (u - libm::log1p(u), -e * u - libm::log1p(-e * u));
        if inward > outward {
            low = u;
        } else {
            high = u;
        }
    }
    0.5 * (low + high)
}

/// Force of a spring of `stiffness` (N/m) at `depth` (m) that is pressed in at `speed` (m/s), of a touch that began at
/// `touched` m/s, N: never a pull.
pub fn force(rebound: f64, stiffness: f64, depth: f64, speed: f64, touched: f64) -> f64 {
    let lambda = rebound / touched.max(SLOWEST);
    (stiffness * depth * (1.0 + lambda * speed)).max(0.0)
}

/// ∂F/∂ẋ of a pad that came to rest at `depth` m by touches below [`SLOWEST`], N·s/m.
pub fn slope(rebound: f64, stiffness: f64, depth: f64) -> f64 {
    stiffness * depth * rebound / SLOWEST
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plant::STEP;

    /// Speed back over speed of a mass of `mass` kg that arrives at `speed` m/s on `stiffness` N/m.
    fn bounce(e: f64, mass: f64, stiffness: f64, speed: f64) -> f64 {
        let (mut x, mut v) = (0.0, speed);
        let dt = 0.1 * STEP;
        while x >= 0.0 {
            v -= force(rebound(e), stiffness, x, v, speed) / mass * dt;
            x += v * dt;
        }
        -v / speed
    }

    #[test]
    fn a_mass_rebounds_with_the_restitution_at_any_speed_mass_and_stiffness() {
        for e in [0.3, 0.65, 0.75, 0.9] {
            for (mass, stiffness, speed) in [(0.45, 4e3, 0.1), (0.45, 4e3, 0.5), (0.1, 750.0, 0.3)] {
                let back = bounce(e, mass, stiffness, speed);
                assert!((back - e).abs() < 0.01, "{e}, {speed} m/s: {back}");
            }
        }
    }

    #[test]
    fn small_losses_follow_the_series_and_none_has_no_damping() {
        assert!((rebound(0.99) / 0.015 - 1.0).abs() < 0.02, "{}", rebound(0.99));
        assert_eq!(rebound(0.0), 0.0);
    }

    /// The difference of the force over the difference of the speed.
    #[test]
    fn a_resting_pad_damps_with_the_slope_of_the_force() {
        let u = rebound(0.7);
        let difference = force(u, 4e3, 1e-3, 0.01, 0.02) - force(u, 4e3, 1e-3, 0.0, 0.02);
        assert!(
            (difference / 0.01 - slope(u, 4e3, 1e-3)).abs() < 1e-9,
            "{difference}"
        );
    }

    #[test]
    fn it_never_pulls() {
        assert_eq!(force(rebound(0.3), 4e3, 1e-3, -3.0, 0.3), 0.0);
    }
}
