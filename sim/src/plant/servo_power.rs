//! Power of the tendon servos from their battery while they hold.

/// Capacity of the servos' battery, A·s: 2S 1200 mAh (paper).
pub const CAPACITY: f64 = 1.2 * 3600.0;

/// Servo current over torque: linear from no load to stall, as of a DC motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoCurrent {
    /// Stall torque, N·m.
    pub stall: f64,
    /// Stall current, A.
    pub at_stall: f64,
    /// Current without load, A.
    pub idle: f64,
}

/// The MG996R at 6 V (datasheet: 11 kgcm), the only servo with known currents.
pub const MG996R: ServoCurrent = ServoCurrent {
    stall: 11.0 * 0.098_066_5,
    at_stall: 2.5,
    idle: 0.17,
};

impl ServoCurrent {
    /// Current (A) while holding `torque` N·m.
    #[must_use]
    pub fn at(&self, torque: f64) -> f64 {
        self.idle + (self.at_stall - self.idle) * torque / self.stall
    }
}

/// Time (s) for which a full battery of `capacity` A·s feeds `current` A.
#[must_use]
pub fn endurance(capacity: f64, current: f64) -> f64 {
    capacity / current
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_servo_draws_its_idle_current_without_load_and_its_stall_current_at_stall() {
        assert!((MG996R.at(0.0) - 0.17).abs() < 1e-12 && (MG996R.at(MG996R.stall) - 2.5).abs() < 1e-12);
        // Four idle servos: 1.2 Ah over 0.68 A, 1 h 46 min.
        assert!((endurance(CAPACITY, 4.0 * MG996R.at(0.0)) / 60.0 - 105.9).abs() < 0.1);
    }
}
