//! First-order low pass and biquads.
//!
//! Stepped at their owners' rates, 50 Hz to 4 kHz. Low passes take the measured step (s); biquads are made for one
//! sampling rate: a missed sample briefly shifts their cut-off.

use crate::maths::scalar;

/// First-order low pass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LowPass {
    value: f32,
}

impl LowPass {
    /// A filter settled at `value`.
    pub const fn at(value: f32) -> Self {
        Self { value }
    }

    /// One step of `dt` s with the cut-off `rate` (rad/s); stable for any positive product. A non-finite input changes
    /// nothing.
    #[inline]
    pub fn step(&mut self, input: f32, rate: f32, dt: f32) -> f32 {
        if input.is_finite() {
            self.blend(input, Self::gain(rate, dt));
        }
        self.value
    }

    /// Share of the way to the input in a step of `dt` s with the cut-off `rate` (rad/s), 0..1. Filters of one cut-off
    /// share its division.
    #[inline(always)]
    pub fn gain(rate: f32, dt: f32) -> f32 {
        let k = rate * dt;
        k / (1.0 + k)
    }

    /// One step by [`Self::gain`] towards a finite `input`.
    #[inline(always)]
    pub fn blend(&mut self, input: f32, gain: f32) -> f32 {
        self.value += (input - self.value) * gain;
        self.value
    }

    /// Output.
    pub const fn value(&self) -> f32 {
        self.value
    }
}

/// Two first-order low passes of the same cut-off in series.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CascadedLowPass {
    first: LowPass,
    second: LowPass,
}

impl CascadedLowPass {
    /// A filter settled at `value`.
    pub const fn at(value: f32) -> Self {
        Self {
            first: LowPass::at(value),
            second: LowPass::at(value),
        }
    }

    /// One step; see [`LowPass::step`].
    pub fn step(&mut self, input: f32, rate: f32, dt: f32) -> f32 {
        let once = self.first.step(input, rate, dt);
        self.second.step(once, rate, dt)
    }

    /// Output.
    pub const fn value(&self) -> f32 {
        self.second.value()
    }

    /// First less second output: an even input's change in one time constant.
    pub fn lead(&self) -> f32 {
        self.first.value() - self.second.value()
    }
}

/// Coefficients of a second-order section, normalised to a0 = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients {
    b0: f32,
    b1: f32,
    b2: f32,
    a1: f32,
    a2: f32,
}

impl Coefficients {
    /// Passes everything.
    pub const IDENTITY: Self = Self {
        b0: 1.0,
        b1: 0.0,
        b2: 0.0,
        a1: 0.0,
        a2: 0.0,
    };

    /// Butterworth low pass with cut-off `hz`, limited to 0.35 of the sampling rate `rate_hz`.
    pub fn low_pass(hz: f32, rate_hz: f32) -> Self {
        let k = Self::warped(hz, rate_hz);
        let norm = 1.0 / (1.0 + core::f32::consts::SQRT_2 * k + k * k);
        let b0 = k * k * norm;
        Self {
            b0,
            b1: 2.0 * b0,
            b2: b0,
            a1: 2.0 * (k * k - 1.0) * norm,
            a2: (1.0 - core::f32::consts::SQRT_2 * k + k * k) * norm,
        }
    }

    /// Notch (s² + 2 ζz ω s + ω²) / (s² + 2 ζp ω s + ω²) at `hz`, sampled at `rate_hz`.
    pub fn notch(hz: f32, zeta_zero: f32, zeta_pole: f32, rate_hz: f32) -> Self {
        let k = Self::warped(hz, rate_hz);
        let norm = 1.0 / (1.0 + 2.0 * zeta_pole * k + k * k);
        let b1 = 2.0 * (k * k - 1.0) * norm;
        Self {
            b0: (1.0 + 2.0 * zeta_zero * k + k * k) * norm,
            b1,
            b2: (1.0 - 2.0 * zeta_zero * k + k * k) * norm,
            a1: b1,
            a2: (1.0 - 2.0 * zeta_pole * k + k * k) * norm,
        }
    }

    /// Gain, a1 and a2 of a low pass; its numerator is the gain times 1, 2, 1.
    pub const fn as_low_pass(self) -> (f32, f32, f32) {
        (self.b0, self.a1, self.a2)
    }

    /// Bilinear transform's warped frequency tan(π f / fs).
    fn warped(hz: f32, rate_hz: f32) -> f32 {
        scalar::tan(scalar::PI * scalar::clamp(hz / rate_hz, 1e-5, 0.35))
    }
}

/// A second-order section, transposed direct form II.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Biquad {
    c: Coefficients,
    s1: f32,
    s2: f32,
}

impl Biquad {
    /// A section at rest at 0.
    pub const fn new(c: Coefficients) -> Self {
        Self { c, s1: 0.0, s2: 0.0 }
    }

    /// One sample.
    #[inline(always)]
    pub fn step(&mut self, x: f32) -> f32 {
        let y = self.c.b0 * x + self.s1;
        self.s1 = self.c.b1 * x - self.c.a1 * y + self.s2;
        self.s2 = self.c.b2 * x - self.c.a2 * y;
        y
    }

    /// Settles at the constant input `value` (unit gain at 0 Hz).
    pub fn reset(&mut self, value: f32) {
        self.s1 = value * (1.0 - self.c.b0);
        self.s2 = value * (self.c.b2 - self.c.a2);
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::f32::consts::TAU;

    use super::*;

    fn gain(mut b: Biquad, hz: f32, rate: f32) -> f32 {
        let n = (rate * (20.0 / hz).max(2.0)) as usize;
        let mut peak = 0.0f32;
        for i in 0..n {
            let y = b.step(f32::sin(TAU * (hz * i as f32 / rate).fract()));
            if i > n / 2 {
                peak = peak.max(y.abs());
            }
        }
        peak
    }

    #[test]
    fn the_low_pass_is_3_db_down_at_its_cut_off() {
        let b = Biquad::new(Coefficients::low_pass(90.0, 4000.0));
        assert!((gain(b, 90.0, 4000.0) - core::f32::consts::FRAC_1_SQRT_2).abs() < 0.005);
        assert!((gain(b, 5.0, 4000.0) - 1.0).abs() < 0.005);
        assert!(gain(b, 900.0, 4000.0) < 0.012);
    }

    #[test]
    fn the_notch_cuts_to_the_ratio_of_its_dampings() {
        // At the centre the gain is ζz/ζp = 0.25, even at 4.75 Hz of 1 kHz, where coefficients are delicate.
        let b = Biquad::new(Coefficients::notch(4.75, 0.2, 0.8, 1000.0));
        assert!((gain(b, 4.75, 1000.0) - 0.25).abs() < 0.005);
        assert!((gain(b, 0.2, 1000.0) - 1.0).abs() < 0.01);
        assert!((gain(b, 91.0, 1000.0) - 1.0).abs() < 0.015);
    }

    #[test]
    fn reset_starts_without_a_transient() {
        for c in [
            Coefficients::low_pass(90.0, 1000.0),
            Coefficients::notch(4.75, 0.2, 0.8, 1000.0),
        ] {
            let mut b = Biquad::new(c);
            b.reset(2.5);
            for _ in 0..1000 {
                assert!((b.step(2.5) - 2.5).abs() < 2e-3);
            }
        }
    }

    #[test]
    fn the_first_order_filter_reaches_63_percent_in_one_time_constant() {
        let mut f = LowPass::default();
        for _ in 0..1000 {
            f.step(1.0, 10.0, 1e-4);
        }
        assert!((f.value() - 0.632).abs() < 0.001);
        assert!(f.step(1.0, 1e6, 1.0) <= 1.0);
    }
}
