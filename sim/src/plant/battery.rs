//! Flight and servo battery: lithium cells with a resistance, and a slow sag: a second resistance beside a capacity, the
//! concentration that a current builds up in the cells within 20 s.

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
/// Time constant of the slow sag, s (10 to 30 s are usual for lithium-polymer cells).
const SAG_TIME: f64 = 20.0;
/// V per cell, per 10 % of charge from 0 (typical LiPo).
const OPEN_VOLTAGE: [f64; 11] = [3.27, 3.69, 3.73, 3.77, 3.80, 3.84, 3.87, 3.95, 4.02, 4.11, 4.20];

/// The battery's state.
#[derive(Clone, Copy, Debug)]
pub struct Battery {
    pack: Pack,
    charge: f64,
    current: f64,
    /// Resistance of the slow sag, Ω.
    sag_resistance: f64,
    /// Slow sag, V.
    sag: f64,
}

impl Battery {
    /// A flight battery with `charge` (0..1) of its capacity.
    #[must_use]
    pub fn new(charge: f64) -> Self {
        Self::of(FLIGHT, charge)
    }

    /// A servo battery with `charge` (0..1) of its `capacity`, A·s.
    #[must_use]
    pub fn of_servos(capacity: f64, charge: f64) -> Self {
        Self::of(Pack { capacity, ..SERVOS }, charge)
    }

    fn of(pack: Pack, charge: f64) -> Self {
        Self {
            pack,
            charge: charge.clamp(0.0, 1.0),
            current: pack.always,
            sag_resistance: 0.0,
            sag: 0.0,
        }
    }

    /// The same with `age` times the resistance of a new pack, and `sag` Ω that a current meets slowly.
    #[must_use]
    pub fn aged(mut self, age: f64, sag: f64) -> Self {
        self.pack.resistance *= age;
        self.sag_resistance = sag;
        self
    }

    /// Another pack of the same make and age with `charge` (0..1), at rest.
    #[must_use]
    pub fn exchanged(self, charge: f64) -> Self {
        Self {
            charge: charge.clamp(0.0, 1.0),
            sag: 0.0,
            ..self
        }
    }

    /// Draws `current` A, of motors or servos, for `dt` s.
    pub fn step(&mut self, dt: f64, current: f64) {
        self.current = current + self.pack.always;
        if self.sag_resistance > 0.0 {
            self.sag += (self.current * self.sag_resistance - self.sag) * (dt / SAG_TIME);
        }
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
        self.pack.cells * (low + (high - low) * (x - i as f64))
            - self.current * self.pack.resistance
            - self.sag
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

    /// 20 A over 35 mΩ twice, and over 20 mΩ to 63 % within the time constant.
    #[test]
    fn an_old_pack_sags_at_once_and_slowly() {
        let fresh = |age, sag| {
            let mut b = Battery::new(1.0).aged(age, sag);
            b.step(1e-6, 20.0 - FLIGHT.always);
            b
        };
        let at_once = fresh(1.0, 0.02).voltage() - fresh(2.0, 0.02).voltage();
        assert!((at_once - 20.0 * 0.035).abs() < 1e-5, "{at_once}");
        let (mut quick, mut slow) = (fresh(1.0, 0.0), fresh(1.0, 0.02));
        for _ in 0..2000 {
            for b in [&mut quick, &mut slow] {
                b.step(0.01, 20.0 - FLIGHT.always);
            }
        }
        let sag = quick.voltage() - slow.voltage();
        assert!((sag - 0.632 * 0.4).abs() < 1e-3, "{sag}");
    }

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
        let mut b = Battery::of_servos(servo_power::CAPACITY, 0.1);
        assert!((b.voltage() - 7.38).abs() < 1e-9 && !b.empty());
        // 432 A s.
        b.step(100.0, 4.32);
        assert!((b.voltage() - (6.54 - 0.216)).abs() < 1e-9 && b.empty());
    }
}
