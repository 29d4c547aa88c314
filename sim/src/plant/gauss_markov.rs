//! First-order Gauss-Markov processes: noise with an RMS and a correlation time.

use glam::DVec3;

/// Three components, each independent.
#[derive(Clone, Copy, Debug)]
pub struct GaussMarkov {
    /// RMS of each component.
    rms: DVec3,
    /// Correlation time, s.
    time: f64,
    value: DVec3,
}

impl GaussMarkov {
    /// A process of `rms` a component and a correlation `time`, s, from zero.
    #[must_use]
    pub fn new(rms: DVec3, time: f64) -> Self {
        Self {
            rms,
            time,
            value: DVec3::ZERO,
        }
    }

    /// Advances by `dt` s, short against the correlation time, with standard normal numbers.
    pub fn step(&mut self, dt: f64, normal: DVec3) {
        let k = dt / self.time;
        self.value += -self.value * k + normal * self.rms * (2.0 * k).sqrt();
    }

    /// The components.
    #[must_use]
    pub fn value(&self) -> DVec3 {
        self.value
    }
}
