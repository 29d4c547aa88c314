//! The beam's section: curvature over moment, chosen so that the tip follows Eq. 1.
//!
//! A thrust T bends the section at ξ by the moment M = T L (1 - ξ). With the curvature c1 M + c2 M² the tip tilts by
//! c1 T L²/2 + c2 T² L³/3; Eq. 1's A T + B T² therefore needs c1 = 2A/L², c2 = 3B/L³. A taper e(ξ) divides the curvature. As Eq. 1 is measured with the arm's
//! weight on it, the moment counts from what weight alone does on a level bench.

use super::super::contact::ARM_LENGTH;
use super::super::hinged::link::ArmSpec;
use super::masses::{MIDDLE, Masses};
use super::twist::TwistSpec;
use super::{PerTerm, TERMS};

/// Least compliance of a section over that at rest, where Eq. 1's parabola turns (assumed). With 0.1 the tilt stays
/// within 0.3° of Eq. 1 up to 7 N at ρ 6.9.
const LEAST_COMPLIANCE: f64 = 0.1;
/// Gauss's three points on 0..1 and their weights.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_3, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
/// Hover thrust, N: the damping ratio holds here.
const HOVER_THRUST: f64 = 4.425;

/// An arm as built.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeamSpec {
    /// Curvature over moment at rest, 1/(N·m²).
    linear: f64,
    /// Its change, 1/(N²·m³).
    quadratic: f64,
    /// Bending stiffness of the tip over the root's.
    taper: f64,
    /// Moment beyond which the section is linear, N·m, and the curvature there, 1/m.
    knee: (f64, f64),
    /// Slope of the tip at rest, rad: the arm is a circular arc then.
    pub(super) rest: f64,
    pub(super) masses: Masses,
    /// Generalised damping, N·m·s.
    pub(super) damping: [PerTerm; TERMS],
    pub(super) twist: TwistSpec,
}

impl BeamSpec {
    /// The beam that follows `spec`'s Eq. 1, carries `masses` and is damped by the ratio `zeta` in both modes and in
    /// torsion; alike along its length.
    #[must_use]
    pub fn of(spec: &ArmSpec, masses: Masses, zeta: f64) -> Self {
        Self::tapered(spec, masses, zeta, 1.0)
    }

    /// As [`BeamSpec::of`], with a stiffness that changes evenly from the root to `taper` times as much at the tip.
    #[must_use]
    pub fn tapered(spec: &ArmSpec, masses: Masses, zeta: f64, taper: f64) -> Self {
        let (a, b) = spec.elastic();
        let linear = a / (ARM_LENGTH * ARM_LENGTH * tip_by_thrust(taper));
        // ∫ (1 - ξ)² / e dξ is 1/3 for a uniform beam.
        let square: f64 = GAUSS
            .iter()
            .map(|(xi, weight)| weight * (1.0 - xi) * (1.0 - xi) / stiffness_share(taper, *xi))
            .sum();
        let quadratic = b / (ARM_LENGTH * ARM_LENGTH * ARM_LENGTH * square);
        let knee = if quadratic < 0.0 {
            linear * (1.0 - LEAST_COMPLIANCE) / (-2.0 * quadratic)
        } else {
            f64::INFINITY
        };
        let mut beam = Self {
            linear,
            quadratic,
            taper,
            knee: (knee, (linear + quadratic * knee) * knee),
            rest: spec.static_tilt(0.0),
            masses,
            damping: [[0.0; TERMS]; TERMS],
            twist: TwistSpec::of(1.0 / linear, masses.block, zeta),
        };
        beam.damping = beam.rayleigh(zeta);
        beam
    }

    /// The same with `factor` times the torsional stiffness; its damping keeps the ratio.
    #[must_use]
    pub fn twisting(mut self, factor: f64) -> Self {
        self.twist.stiffness *= factor;
        self.twist.damping *= factor.sqrt();
        self
    }

    /// Tangent stiffness in hover, N·m.
    pub(super) fn in_hover(&self) -> [PerTerm; TERMS] {
        self.tangent(HOVER_THRUST)
    }

    /// Bending stiffness of the root at rest, N·m².
    #[must_use]
    pub fn bending_stiffness(&self) -> f64 {
        1.0 / self.linear
    }

    /// Torsional stiffness, N·m/rad.
    #[must_use]
    pub const fn torsional_stiffness(&self) -> f64 {
        self.twist.stiffness
    }

    /// Moment (N·m) at the elastic `curvature` (1/m): linear below 0 and beyond the knee, outside Eq. 1's measurements
    /// (assumed).
    #[must_use]
    pub fn moment(&self, curvature: f64) -> f64 {
        if curvature <= 0.0 {
            return curvature / self.linear;
        }
        let (knee, curvature_knee) = self.knee;
        if curvature >= curvature_knee {
            return knee + (curvature - curvature_knee) / (LEAST_COMPLIANCE * self.linear);
        }
        // Root of c2 M² + c1 M = κ that vanishes with κ, also for c2 = 0.
        let root = (self.linear * self.linear + 4.0 * self.quadratic * curvature).sqrt();
        2.0 * curvature / (self.linear + root)
    }

    /// Curvature (1/m) under `moment` (N·m).
    #[must_use]
    pub fn curvature(&self, moment: f64) -> f64 {
        let (knee, curvature_knee) = self.knee;
        if moment <= 0.0 {
            self.linear * moment
        } else if moment >= knee {
            curvature_knee + LEAST_COMPLIANCE * self.linear * (moment - knee)
        } else {
            (self.linear + self.quadratic * moment) * moment
        }
    }

    /// Generalised force of the bent sections on each term, N·m.
    pub(super) fn elastic(&self, q: &PerTerm) -> PerTerm {
        let mut sum = [0.0; TERMS];
        for (xi, weight) in GAUSS {
            let curvature = (q[0] - self.rest + 2.0 * xi * q[1]) / ARM_LENGTH;
            let moment = weight * self.moment(curvature * stiffness_share(self.taper, xi));
            sum[0] -= moment;
            sum[1] -= moment * 2.0 * xi;
        }
        sum
    }

    /// Damping with the ratio `zeta` in both modes of a straight arm in hover: a0 M + a1 K with a1 = 2ζ/(ω1 + ω2) and a0
    /// = a1 ω1 ω2.
    fn rayleigh(&self, zeta: f64) -> [PerTerm; TERMS] {
        let (m, k) = (self.straight_mass(), self.tangent(HOVER_THRUST));
        let [slow, fast] = frequencies(&m, &k);
        let a1 = 2.0 * zeta / (slow + fast);
        let a0 = a1 * slow * fast;
        std::array::from_fn(|i| std::array::from_fn(|j| a0 * m[i][j] + a1 * k[i][j]))
    }

    /// Frequencies of a straight clamped arm at `thrust` N, Hz.
    #[must_use]
    pub fn modes(&self, thrust: f64) -> [f64; TERMS] {
        frequencies(&self.straight_mass(), &self.tangent(thrust)).map(|w| w / std::f64::consts::TAU)
    }

    fn straight_mass(&self) -> [PerTerm; TERMS] {
        let at = |xi: f64| [0.5 * ARM_LENGTH * xi * xi, ARM_LENGTH * xi * xi * xi / 3.0];
        let (middle, tip) = (at(MIDDLE), at(1.0));
        let Masses {
            middle: m,
            tip: t,
            block,
        } = self.masses;
        std::array::from_fn(|i| {
            std::array::from_fn(|j| m * middle[i] * middle[j] + t * tip[i] * tip[j] + block)
        })
    }

    /// Tangent stiffness at a tip thrust, N·m.
    fn tangent(&self, thrust: f64) -> [PerTerm; TERMS] {
        let mut k = [[0.0; TERMS]; TERMS];
        for (xi, weight) in GAUSS {
            let moment = thrust * ARM_LENGTH * (1.0 - xi);
            let compliance =
                (self.linear + 2.0 * self.quadratic * moment).max(LEAST_COMPLIANCE * self.linear);
            let (by, share) = ([1.0, 2.0 * xi], stiffness_share(self.taper, xi));
            for (row, i) in k.iter_mut().zip(by) {
                for (entry, j) in row.iter_mut().zip(by) {
                    *entry += weight * i * j * share / (compliance * ARM_LENGTH);
                }
            }
        }
        k
    }
}

/// Stiffness at ξ over the root's.
fn stiffness_share(taper: f64, xi: f64) -> f64 {
    1.0 - (1.0 - taper) * xi
}

/// Tilt of the tip, of two terms, by a unit thrust on a beam of unit length and root stiffness: 1/2 if alike along it.
fn tip_by_thrust(taper: f64) -> f64 {
    let (mut a, mut b, mut d) = (0.0, 0.0, 0.0);
    for (xi, weight) in GAUSS {
        let share = weight * stiffness_share(taper, xi);
        a += share;
        b += share * 2.0 * xi;
        d += share * 4.0 * xi * xi;
    }
    // K q = (1/2, 1/3).
    let q = [d / 2.0 - b / 3.0, a / 3.0 - b / 2.0];
    (q[0] + q[1]) / (a * d - b * b)
}

/// Roots of det(K - ω² M), rad/s.
fn frequencies(m: &[PerTerm; TERMS], k: &[PerTerm; TERMS]) -> [f64; TERMS] {
    let a = m[0][0] * m[1][1] - m[0][1] * m[1][0];
    let b = m[0][0] * k[1][1] + m[1][1] * k[0][0] - m[0][1] * k[1][0] - m[1][0] * k[0][1];
    let c = k[0][0] * k[1][1] - k[0][1] * k[1][0];
    let root = (b * b - 4.0 * a * c).max(0.0).sqrt();
    [2.0 * c / (b + root), (b + root) / (2.0 * a)].map(f64::sqrt)
}
