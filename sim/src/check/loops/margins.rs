//! Stability and margins of a loop from its gain over frequency.

use super::response::{Complex, difference};
use std::f64::consts::{PI, TAU};

/// Margins of a loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Margins {
    /// Factor by which the gain may rise or fall, the nearer of both; below 1 for an oscillating loop: the share of its
    /// gain at which it is stable.
    pub gain: f64,
    /// Phase margin, rad; negative for an oscillating loop.
    pub phase: f64,
    /// Disk margin: the loop is stable with any factor (1 + δ/2) / (1 - δ/2), |δ| below it, on its gain: gain and phase off
    /// at once. 2 at most for a loop that a gain of 0 leaves stable; 0 for an oscillating one.
    pub disk: f64,
    /// Frequency of the disk margin, rad/s.
    pub critical: f64,
    /// Highest frequency at which the gain is 1, rad/s (bandwidth); 0 without one.
    pub crossover: f64,
}

impl Margins {
    /// Margins from the gains `curve` over rising frequencies (rad/s), of a loop of steps of `step` s.
    ///
    /// The closed loop divides by 1 + L. With a factor 1 - z⁻¹ for each of L's n integrators all poles of
    /// F = (1 + L)(1 - z⁻¹)ⁿ are inside the unit circle, so along half of it, from a real number to another, F turns
    /// about 0 by π for each pole of the closed loop outside. A loop is stable if F does not turn.
    #[must_use]
    pub fn of(curve: &[(f64, Complex)], step: f64) -> Self {
        let stable = turned(curve, step).abs() < PI;
        let (mut up, mut down, mut phase, mut crossover) = (f64::INFINITY, 0.0_f64, PI, 0.0);
        for ((_, a), (omega, b)) in curve.iter().zip(curve.iter().skip(1)) {
            // Phase crossover: through the negative real axis.
            if a.y * b.y <= 0.0 && a.x < 0.0 && b.x < 0.0 {
                let share = a.y / (a.y - b.y);
                let size = -(a.x + share * (b.x - a.x));
                if size < 1.0 {
                    up = up.min(1.0 / size);
                } else {
                    down = down.max(1.0 / size);
                }
            }
            if (a.length() - 1.0) * (b.length() - 1.0) <= 0.0 {
                crossover = *omega;
                let left = (b.to_angle() + TAU).rem_euclid(TAU) - PI;
                phase = if left.abs() < phase.abs() { left } else { phase };
            }
        }
        let (disk, critical) = disk(curve);
        if stable {
            Self {
                disk,
                critical,
                gain: up.min(1.0 / down),
                phase: phase.abs(),
                crossover,
            }
        } else {
            // The stable gain lies beyond the nearest crossing passed.
            let passed = if down > 0.0 { down } else { 1.0 / up };
            Self {
                disk: 0.0,
                critical,
                gain: passed.min(1.0),
                phase: -phase.abs(),
                crossover,
            }
        }
    }
}

/// Least 2 |1 + L| / |1 - L| along `curve`, and where, rad/s (Seiler, Packard and Gahinet, An introduction to disk margins, 2020).
fn disk(curve: &[(f64, Complex)]) -> (f64, f64) {
    curve
        .iter()
        .map(|(omega, gain)| {
            let size = 2.0 * (Complex::X + *gain).length() / (Complex::X - *gain).length();
            (size, *omega)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((0.0, 0.0))
}

/// Slope of the gain at the lowest frequencies. Turn rate, angle and the rate loop's integral are integrators, fewer
/// where a gain is 0.
fn integrators(curve: &[(f64, Complex)]) -> u32 {
    let Some(((low, a), (high, b))) = curve.first().zip(curve.get(1)) else {
        return 0;
    };
    let slope = libm::log(a.length() / b.length()) / libm::log(high / low);
    if slope.is_finite() {
        slope.round().clamp(0.0, 4.0) as u32
    } else {
        0
    }
}

/// Angle by which F turns along `curve`, rad.
fn turned(curve: &[(f64, Complex)], step: f64) -> f64 {
    let integrators = integrators(curve);
    let closed = |(omega, gain): &(f64, Complex)| {
        let angle = omega * step;
        let factor = difference(angle);
        (0..integrators).fold(Complex::X + *gain, |f, _| f.rotate(factor))
    };
    curve
        .iter()
        .zip(curve.iter().skip(1))
        .map(|(a, b)| closed(a).angle_to(closed(b)))
        .sum()
}

#[cfg(test)]
mod tests {
    use super::super::frequencies;
    use super::super::response::quotient;
    use super::*;

    fn margins(gain: impl Fn(Complex) -> Complex) -> Margins {
        let curve: Vec<_> = frequencies().map(|w| (w, gain(Complex::new(0.0, w)))).collect();
        Margins::of(&curve, super::super::STEP)
    }

    fn one_over(s: Complex) -> Complex {
        quotient(Complex::X, s)
    }

    #[test]
    fn an_integrator_with_two_lags_by_hand() {
        // k / (s (0.05 s + 1)²): phase -180° at 20 rad/s, where the gain is k/40.
        for (k, gain) in [(10.0, 4.0), (30.0, 40.0 / 30.0), (80.0, 0.5)] {
            let m = margins(|s| {
                let lag = one_over(s * 0.05 + Complex::X);
                one_over(s).rotate(lag).rotate(lag) * k
            });
            assert!((m.gain / gain - 1.0).abs() < 0.02, "{k}: {m:?}");
            assert!((m.phase > 0.0) == (gain > 1.0), "{k}: {m:?}");
        }
    }

    #[test]
    fn an_integrator_alone_has_a_quarter_turn_left() {
        let m = margins(|s| one_over(s) * 5.0);
        assert!(
            (m.phase - 0.5 * PI).abs() < 0.03 && (m.crossover / 5.0 - 1.0).abs() < 0.05,
            "{m:?}"
        );
        assert!(m.gain > 100.0);
    }

    #[test]
    fn the_disk_is_within_the_margins_of_gain_and_phase() {
        // |1 - 1/s| = |1 + 1/s| along the imaginary axis.
        let integrator = margins(|s| one_over(s) * 5.0);
        assert!((integrator.disk - 2.0).abs() < 1e-6, "{integrator:?}");
        for (k, least) in [(4.0, 1.0), (10.0, 0.6), (30.0, 0.1)] {
            let m = margins(|s| {
                let lag = one_over(s * 0.05 + Complex::X);
                one_over(s).rotate(lag).rotate(lag) * k
            });
            // Margins are found between frequencies 3 % apart.
            let (gain, phase) = ((2.0 + m.disk) / (2.0 - m.disk), 2.0 * libm::atan(0.5 * m.disk));
            assert!(
                m.disk > least && gain <= 1.03 * m.gain && phase <= 1.03 * m.phase,
                "{k}: {m:?}"
            );
        }
        let oscillating = margins(|s| {
            one_over(s)
                .rotate(one_over(s * 0.05 + Complex::X))
                .rotate(one_over(s * 0.05 + Complex::X))
                * 80.0
        });
        assert_eq!(oscillating.disk, 0.0);
    }

    #[test]
    fn a_gain_too_small_for_its_integrals_oscillates_as_well() {
        // k (s + 1)² / s³ needs k > 1/2: below, the integrators' phase is not made up for.
        for (k, gain) in [(0.25, 0.5), (2.0, 4.0)] {
            let m = margins(|s| {
                let (zero, pole) = (s + Complex::X, one_over(s));
                zero.rotate(zero).rotate(pole).rotate(pole).rotate(pole) * k
            });
            assert!((m.gain / gain - 1.0).abs() < 0.02, "{k}: {m:?}");
        }
    }
}
