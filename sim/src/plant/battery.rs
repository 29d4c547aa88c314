//! Flight and servo battery: lithium cells with a resistance.

use super::servo_power;

/// A pack as built.
#[derive(Clone, Copy, Debug)]
struct Pack {
    cells: f64,
    /// Capacity, A·s.
    capacity: f64,
    /// Resistance with the leads, Ω (assumed).
    resistance: f64,
    /// Constant current, A (assumed).
    always: f64,
}

/// 4S 1800 mAh (paper), with the electronics.
const FLIGHT: Pack = Pack {
    cells: 4.0,
    capacity: 1.8 * 3600.0,
    resistance: 0.035,
    always: 0.6,
};
/// 2S 1200 mAh (paper).
const SERVOS: Pack = Pack {
    cells: 2.0,
    capacity: servo_power::CAPACITY,
    resistance: 0.05,
    always: 0.0,
};
/// V per cell, per 10 % of charge from 0 (typical LiPo).
const OPEN_VOLTAGE: [f64; 11] = [3.27, 3.69, 3.73, 3.77, 3.80, 3.84, 3.87, 3.95, 4.02, 4.11, 4.20];

/// The battery's state.
#[derive(Clone, Copy, Debug)]
pub struct Battery {
    pack: Pack,
    charge: f64,
    current: f64,
}

impl Battery {
    /// A flight battery with `charge` (0..1) of its capacity.
    #[must_use]
    pub fn new(charge: f64) -> Self {
        Self::of(FLIGHT, charge)
    }

    /// A servo battery with `charge` (0..1) of its capacity.
    #[must_use]
    pub fn of_servos(charge: f64) -> Self {
        Self::of(SERVOS, charge)
    }

    fn of(pack: Pack, charge: f64) -> Self {
        Self {
            pack,
            charge: charge.clamp(0.0, 1.0),
            current: pack.always,
        }
    }

    /// Draws `current` A, of motors or servos, for `dt` s.
    pub fn step(&mut self, dt: f64, current: f64) {
        self.current = current + self.pack.always;
        self.charge = (self.charge - self.current * dt / self.pack.capacity).max(0.0);
    }

    /// The battery is empty: its consumers have no supply.
    #[must_use]
    pub fn empty(&self) -> bool {
        self.charge <= 0.0
    }

    /// Voltage under load, V.
    #[must_use]
    pub fn voltage(&self) -> f64 {
        let x = self.charge * 10.0;
        let i = (x as usize).min(9);
        let (low, high) = (OPEN_VOLTAGE[i], OPEN_VOLTAGE[i + 1]);
        self.pack.cells * (low + (high - low) * (x - i as f64)) - self.current * self.pack.resistance
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
        assert!((b.voltage() + FLIGHT.always * FLIGHT.resistance - 16.8).abs() < 1e-9);
        b.step(FLIGHT.capacity / 20.0, 10.0 - FLIGHT.always);
        assert!(
            (b.voltage() - (4.0 * 3.84 - 0.35)).abs() < 1e-9,
            "{}",
            b.voltage()
        );
        let mut b = Battery::of_servos(0.1);
        assert!((b.voltage() - 7.38).abs() < 1e-9 && !b.empty());
        // 432 A s.
        b.step(100.0, 4.32);
        assert!((b.voltage() - (6.54 - 0.216)).abs() < 1e-9 && b.empty());
    }
}
