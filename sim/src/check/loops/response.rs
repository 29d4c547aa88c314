//! Impulse responses and their gain over frequency.

use glam::DVec2;

/// x real, y imaginary; [`DVec2::rotate`] is the product.
pub type Complex = DVec2;

/// `a / b`.
#[must_use]
pub fn quotient(a: Complex, b: Complex) -> Complex {
    a.rotate(Complex::new(b.x, -b.y)) / b.length_squared()
}

/// 1 - z⁻¹ at `angle` rad a step: the reciprocal of a sum over all steps.
#[must_use]
pub fn difference(angle: f64) -> Complex {
    Complex::new(1.0, 0.0) - Complex::from_angle(-angle)
}

/// A linear response, stored as differences of its impulse answer, which end even where the answer settles at a value
/// other than 0 (turn rate after a push, integrals).
#[derive(Clone, Debug, PartialEq)]
pub struct Response {
    steps: Vec<f64>,
}

/// Share of the largest difference where the tail is cut off.
const TAIL: f64 = 1e-6;

impl Response {
    /// `answer`: one value a step after an impulse of 1 in the first.
    #[must_use]
    pub fn of(answer: &[f64]) -> Self {
        let mut last = 0.0;
        let mut steps: Vec<f64> = answer
            .iter()
            .map(|&value| value - std::mem::replace(&mut last, value))
            .collect();
        let least = TAIL * steps.iter().fold(0.0, |most: f64, step| most.max(step.abs()));
        let end = steps
            .iter()
            .rposition(|step| step.abs() > least)
            .map_or(0, |i| i + 1);
        steps.truncate(end);
        Self { steps }
    }

    /// Gain at `angle` rad a step, 0 < angle <= π: H = Σ s_n z⁻ⁿ / (1 - z⁻¹).
    #[must_use]
    pub fn at(&self, angle: f64) -> Complex {
        let turn = Complex::from_angle(-angle);
        // Horner's scheme from the last step.
        let sum = self.steps.iter().rev().fold(Complex::ZERO, |sum, step| {
            sum.rotate(turn) + Complex::new(*step, 0.0)
        });
        quotient(sum, difference(angle))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_delay_turns_and_a_sum_divides() {
        let delay = Response::of(&[0.0, 0.0, 1.0, 0.0, 0.0]);
        let sum = Response::of(&[2.0; 50]);
        for angle in [1e-5, 0.01, 1.0, 3.0] {
            assert!((delay.at(angle) - Complex::from_angle(-2.0 * angle)).length() < 1e-9);
            let expected = quotient(Complex::new(2.0, 0.0), difference(angle));
            assert!((sum.at(angle) - expected).length() < 1e-9 * expected.length());
        }
        // At low frequency a sum of 2 a step of 1 ms is an integral: 2000 / (jω).
        let (omega, gain) = (1.0, sum.at(1e-3));
        assert!((gain.length() * omega / 2000.0 - 1.0).abs() < 1e-3 && gain.to_angle() < -1.56);
    }
}
