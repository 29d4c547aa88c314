//! The flight battery: 4S lithium with a resistance.

/// A·s: 1800 mAh (paper).
const CAPACITY: f64 = 1.8 * 3600.0;
/// Pack and leads, Ω (assumed).
const RESISTANCE: f64 = 0.035;
const CELLS: f64 = 4.0;
/// A (assumed).
const ELECTRONICS: f64 = 0.6;
/// V per cell, per 10 % of charge from 0 (typical LiPo).
const OPEN_VOLTAGE: [f64; 11] = [3.27, 3.69, 3.73, 3.77, 3.80, 3.84, 3.87, 3.95, 4.02, 4.11, 4.20];

/// The battery's state.
#[derive(Clone, Copy, Debug)]
pub struct Battery {
    charge: f64,
    current: f64,
}

impl Battery {
    /// A battery with `charge` (0..1) of its capacity.
    #[must_use]
    pub fn new(charge: f64) -> Self {
        Self {
            charge: charge.clamp(0.0, 1.0),
            current: ELECTRONICS,
        }
    }

    /// Draws `motors` A for `dt` s.
    pub fn step(&mut self, dt: f64, motors: f64) {
        self.current = motors + ELECTRONICS;
        self.charge = (self.charge - self.current * dt / CAPACITY).max(0.0);
    }

    /// Voltage under load, V.
    #[must_use]
    pub fn voltage(&self) -> f64 {
        let x = self.charge * 10.0;
        let i = (x as usize).min(9);
        let (low, high) = (OPEN_VOLTAGE[i], OPEN_VOLTAGE[i + 1]);
        CELLS * (low + (high - low) * (x - i as f64)) - self.current * RESISTANCE
    }

    /// Current, A.
    #[must_use]
    pub fn current(&self) -> f64 {
        self.current
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_pack_rests_at_16_8_volts_and_empties() {
        let mut b = Battery::new(1.0);
        assert!((b.voltage() + ELECTRONICS * RESISTANCE - 16.8).abs() < 1e-9);
        b.step(CAPACITY / 20.0, 10.0 - ELECTRONICS);
        assert!(
            (b.voltage() - (4.0 * 3.84 - 0.35)).abs() < 1e-9,
            "{}",
            b.voltage()
        );
    }
}
