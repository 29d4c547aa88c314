//! Voltage dividers of both batteries and current sensor.

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Reference voltage of the converter, V.
const REFERENCE: f64 = 3.3;
/// Volts at a pin per count.
pub const PIN_VOLTS_PER_COUNT: f64 = REFERENCE / 4095.0;
/// Reference board: 10 kΩ over 1 kΩ.
const DIVIDER: f64 = 11.0;
/// Reference board, A/V.
const AMPS_PER_VOLT: f64 = 40.0;
/// Largest gain error of divider and current sensor.
const GAIN_ERROR: (f64, f64) = (0.01, 0.03);
/// Largest offset of the current sensor, A.
const OFFSET: f64 = 0.3;
/// RMS noise, counts: motors share the supply.
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
    rng: Pcg64Mcg,
    servo_gain: f64,
    servo_rng: Pcg64Mcg,
}

impl BatteryInputs {
    /// Inputs with the errors of `streams`.
    #[must_use]
    pub fn new(streams: Streams) -> Self {
        let within = |what: &str, size: f64| streams.within(&format!("battery.{what}"), -size, size);
        Self {
            voltage_gain: 1.0 + within("voltage", GAIN_ERROR.0),
            current_gain: 1.0 + within("current", GAIN_ERROR.1),
            current_offset: within("offset", OFFSET),
            rng: streams.of("battery"),
            servo_gain: 1.0 + within("servos", GAIN_ERROR.0),
            servo_rng: streams.of("servo battery"),
        }
    }

    /// Counts for a true voltage (V).
    pub fn voltage(&mut self, volts: f64) -> u16 {
        counts(volts * self.voltage_gain / VOLTS_PER_COUNT, &mut self.rng)
    }

    /// Counts for a true voltage (V) of the servo battery, behind the same divider.
    pub fn servo_voltage(&mut self, volts: f64) -> u16 {
        counts(volts * self.servo_gain / VOLTS_PER_COUNT, &mut self.servo_rng)
    }

    /// Counts for a true current (A).
    pub fn current(&mut self, amps: f64) -> u16 {
        counts(
            (amps * self.current_gain + self.current_offset) / AMPS_PER_COUNT,
            &mut self.rng,
        )
    }
}

fn counts(ideal: f64, rng: &mut Pcg64Mcg) -> u16 {
    let noise: f64 = StandardNormal.sample(rng);
    (ideal + NOISE * noise).round().clamp(0.0, 4095.0) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_scale_back_to_volts_and_amperes() {
        for seed in 0..200 {
            let mut b = BatteryInputs::new(Streams::new(seed));
            let v = f64::from(b.voltage(15.2)) * VOLTS_PER_COUNT;
            let i = f64::from(b.current(40.0)) * AMPS_PER_COUNT;
            // 1 % and four sigma of 2 counts; 3 %, the offset and four sigma.
            assert!(
                (v - 15.2).abs() < 0.152 + 0.08 && (i - 40.0).abs() < 1.2 + 0.3 + 0.45,
                "{v} {i}"
            );
        }
        let mut b = BatteryInputs::new(Streams::new(1));
        assert!(b.voltage(100.0) == 4095 && b.current(-50.0) == 0);
    }
}
