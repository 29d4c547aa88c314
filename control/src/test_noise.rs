//! Reproducible noise for tests: a linear congruential generator, the same on every machine.

/// The generator.
pub struct TestNoise(pub u32);

impl TestNoise {
    /// Evenly in [0, 1).
    pub fn uniform(&mut self) -> f32 {
        self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (self.0 >> 8) as f32 / 16_777_216.0
    }

    /// Nearly normal with the deviation 1: twelve of them, less their mean.
    pub fn normal(&mut self) -> f32 {
        (0..12).map(|_| self.uniform()).sum::<f32>() - 6.0
    }
}
