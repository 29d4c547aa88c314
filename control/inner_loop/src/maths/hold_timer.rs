//! Debounce of a condition.

use super::scalar::clamp;

/// Unbroken time of a condition, s.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HoldTimer(f32);

impl HoldTimer {
    /// One step; returns the time, s, 0 while the condition fails.
    pub fn step(&mut self, holds: bool, dt: f32) -> f32 {
        self.0 = if holds { clamp(self.0 + dt, 0.0, 1e6) } else { 0.0 };
        self.0
    }

    /// The time, s.
    pub fn time(self) -> f32 {
        self.0
    }
}
