//! Battery voltage divider and current sensor.

use rand::Rng;
use rand_distr::{Distribution, StandardNormal, Uniform};

/// Of the converter, V.
const REFERENCE: f64 = 3.3;
/// Volts at a pin per count.
pub const PIN_VOLTS_PER_COUNT: f64 = REFERENCE / 4095.0;
/// Reference board: 10 kΩ over 1 kΩ.
const DIVIDER: f64 = 11.0;
/// Reference board, A/V.
const AMPS_PER_VOLT: f64 = 40.0;
/// Largest, of divider and current sensor.
const GAIN_ERROR: (f64, f64) = (0.01, 0.03);
/// Largest, of the current sensor, A.
const OFFSET: f64 = 0.3;
/// RMS, counts: motors share the supply.
const NOISE: f64 = 2.0;

/// Volts of battery per count.
pub const VOLTS_PER_COUNT: f64 = PIN_VOLTS_PER_COUNT * DIVIDER;
/// Amperes per count.
pub const AMPS_PER_COUNT: f64 = PIN_VOLTS_PER_COUNT * AMPS_PER_VOLT;

/// The battery inputs of one board.
#[derive(Clone, Debug)]
pub struct BatteryInputs {
    voltage_gain: f64,
    current_gain: f64,
    current_offset: f64,
}

impl BatteryInputs {
    /// Errors drawn from `rng`.
    pub fn new(rng: &mut impl Rng) -> Self {
        let mut within = |size: f64| Uniform::new(-size, size).map_or(0.0, |u| u.sample(rng));
        Self {
            voltage_gain: 1.0 + within(GAIN_ERROR.0),
            current_gain: 1.0 + within(GAIN_ERROR.1),
            current_offset: within(OFFSET),
        }
    }

    /// Counts for a true voltage (V).
    pub fn voltage(&self, volts: f64, rng: &mut impl Rng) -> u16 {
        counts(volts * self.voltage_gain / VOLTS_PER_COUNT, rng)
    }

    /// Counts for a true current (A).
    pub fn current(&self, amps: f64, rng: &mut impl Rng) -> u16 {
        counts(
            (amps * self.current_gain + self.current_offset) / AMPS_PER_COUNT,
            rng,
        )
    }
}

fn counts(ideal: f64, rng: &mut impl Rng) -> u16 {
    let noise: f64 = StandardNormal.sample(rng);
    (ideal + NOISE * noise).round().clamp(0.0, 4095.0) as u16
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_pcg::Pcg64Mcg;

    use super::*;

    #[test]
    fn counts_scale_back_to_volts_and_amperes() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for _ in 0..200 {
            let b = BatteryInputs::new(&mut rng);
            let v = f64::from(b.voltage(15.2, &mut rng)) * VOLTS_PER_COUNT;
            let i = f64::from(b.current(40.0, &mut rng)) * AMPS_PER_COUNT;
            // 1 % and four sigma of 2 counts; 3 %, the offset and four sigma.
            assert!(
                (v - 15.2).abs() < 0.152 + 0.08 && (i - 40.0).abs() < 1.2 + 0.3 + 0.45,
                "{v} {i}"
            );
        }
        let b = BatteryInputs::new(&mut rng);
        assert!(b.voltage(100.0, &mut rng) == 4095 && b.current(-50.0, &mut rng) == 0);
    }
}
