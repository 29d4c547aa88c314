//! Flight battery from voltage and current, servo battery from its voltage.
//!
//! [`Monitor::step`] runs at 100 Hz in the task `analog` (V, A, s). An implausible voltage publishes no message: the
//! last one ages, is stale after 500 ms, and the vehicle lands a second later; until then thrusts are compensated for
//! the last voltage. An implausible current drops only the current.

use crate::allocation::thrust_curve::voltage_ratio;
use crate::maths::filter::LowPass;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar;
use crate::params::Params;

/// Cut-off of the voltage, rad/s (2 Hz): between a manoeuvre's sag and the discharge.
const VOLTAGE_CUTOFF: f32 = 12.6;
/// Cut-off of the current, rad/s (2 Hz).
const CURRENT_CUTOFF: f32 = 12.6;
/// Bounds of the thrust curve's voltage ratio: 4S from 10.4 to 18.5 V.
const RATIO_BOUNDS: (f32, f32) = (0.7, 1.25);
/// Largest plausible readings: V, A.
const SANE: (f32, f32) = (60.0, 300.0);
/// Counts from which a reading may be the rail, to which a torn lead floats: full scale less the converter's total
/// error (5 counts at most: STM32F405 and F765 datasheets, ADC accuracy).
const RAIL_COUNTS: u16 = 4090;
/// Time without a current after which the charge is unknown, s: 2 % of the battery in hover.
const UNCOUNTED_MAX: f32 = 10.0;

/// The voltage (or current) of `counts`, `scale` per count; `None` at full scale, where the input saturates.
pub fn reading(counts: u16, scale: f32) -> Option<f32> {
    (counts < RAIL_COUNTS).then(|| f32::from(counts) * scale)
}

/// Measured state of the flight battery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery {
    /// Voltage under load, V, low-passed.
    pub voltage: f32,
    /// Current, A, low-passed; `None` while its reading is implausible.
    pub current: Option<f32>,
    /// Charge drawn since power-up, A·s; `None` once too much of it went uncounted.
    pub used: Option<f32>,
    /// Root of what the voltage makes of the thrust, of the bounded voltage over nominal ([`voltage_ratio`]).
    pub ratio: f32,
}

/// The battery's filters and counters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Monitor {
    voltage: Option<LowPass>,
    /// Time since the last voltage, s.
    unread: f32,
    current: Option<LowPass>,
    used: f32,
    /// Charge not yet in `used`, A·s.
    fraction: f32,
    /// Time without a current, s.
    uncounted: f32,
}

impl Monitor {
    /// Adds `voltage` V and `current` A, `dt` s after the last. `None` without a plausible voltage: the last
    /// measurement is older than this step.
    pub fn step(
        &mut self,
        p: &Params,
        voltage: Option<f32>,
        current: Option<f32>,
        dt: f32,
    ) -> Option<Battery> {
        let dt = scalar::clamp(dt, 0.0, 1.0);
        let current = self.step_current(current.filter(|i| (-SANE.1..SANE.1).contains(i)), dt);
        self.unread = scalar::clamp(self.unread + dt, 0.0, 1.0);
        let voltage = voltage.filter(|v| (0.0..SANE.0).contains(v))?;
        let voltage =
            self.voltage
                .get_or_insert(LowPass::at(voltage))
                .step(voltage, VOLTAGE_CUTOFF, self.unread);
        self.unread = 0.0;
        Some(Battery {
            voltage,
            current,
            used: (self.uncounted < UNCOUNTED_MAX).then_some(self.used + self.fraction),
            ratio: voltage_ratio(
                scalar::clamp(voltage / p.battery_nominal, RATIO_BOUNDS.0, RATIO_BOUNDS.1),
                p,
            ),
        })
    }

    /// Filters the current and counts its charge. After a gap the filter starts from the reading.
    fn step_current(&mut self, current: Option<f32>, dt: f32) -> Option<f32> {
        let Some(current) = current else {
            self.current = None;
            self.uncounted = scalar::clamp(self.uncounted + dt, 0.0, UNCOUNTED_MAX);
            return None;
        };
        let filter = self.current.get_or_insert(LowPass::at(current));
        let filtered = filter.step(current, CURRENT_CUTOFF, dt);
        self.add_charge(filtered * dt);
        Some(filtered)
    }

    /// Adds charge in portions of 1 A·s: 10 ms of 1 A would vanish beside 6000 A·s in an `f32`.
    fn add_charge(&mut self, charge: f32) {
        self.fraction += charge;
        if self.fraction.abs() > 1.0 {
            self.used = scalar::clamp(self.used + self.fraction, 0.0, 1e7);
            self.fraction = 0.0;
        }
    }
}

/// Time below a warning voltage of the servo battery before it counts, s: longer than a closing (2.6 to 3.9 s in the paper),
/// under which the voltage sags.
pub const SERVO_SAG_TIME: f32 = 5.0;

/// State of the servo battery.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ServoSupply {
    /// The board does not measure it.
    #[default]
    NotFitted,
    /// It should be measured, but its voltage is stale.
    Silent,
    /// Below `servo_batt_low`: no perch begins.
    Low,
    /// Below `servo_batt_warn`: the vehicle should leave its perch.
    NearEnd,
    /// Above both.
    Good,
}

/// Measured state of the servo battery.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ServoBattery {
    /// Voltage under load, V, low-passed.
    pub voltage: f32,
    /// State by that voltage: `Low`, `NearEnd` or `Good`.
    pub supply: ServoSupply,
}

/// The servo battery's filter and warning voltages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ServoMonitor {
    voltage: Option<LowPass>,
    /// Time since the last voltage, s.
    unread: f32,
    near_end: HoldTimer,
    low: HoldTimer,
}

impl ServoMonitor {
    /// Adds `voltage` V, `dt` s after the last. `None` without a plausible voltage, as [`Monitor::step`].
    pub fn step(&mut self, p: &Params, voltage: Option<f32>, dt: f32) -> Option<ServoBattery> {
        self.unread = scalar::clamp(self.unread + dt, 0.0, 1.0);
        let voltage = voltage.filter(|v| (0.0..SANE.0).contains(v))?;
        // A low battery at power-up is not sagging under a closing: it counts at once.
        let held = if self.voltage.is_none() {
            SERVO_SAG_TIME
        } else {
            self.unread
        };
        let voltage =
            self.voltage
                .get_or_insert(LowPass::at(voltage))
                .step(voltage, VOLTAGE_CUTOFF, self.unread);
        self.unread = 0.0;
        let near_end = self.near_end.step(voltage < p.servo_batt_warn, held) >= SERVO_SAG_TIME;
        let low = self.low.step(voltage < p.servo_batt_low, held) >= SERVO_SAG_TIME;
        let supply = match (low, near_end) {
            (true, _) => ServoSupply::Low,
            (false, true) => ServoSupply::NearEnd,
            (false, false) => ServoSupply::Good,
        };
        Some(ServoBattery { voltage, supply })
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn run(m: &mut Monitor, voltage: f32, current: f32, seconds: f32) -> Battery {
        let p = Params::default();
        let mut last = Battery::default();
        for _ in 0..(seconds * 100.0) as u32 {
            last = m.step(&p, Some(voltage), Some(current), 0.01).unwrap_or_default();
        }
        last
    }

    #[test]
    fn charge_adds_up() {
        let r = run(&mut Monitor::default(), 15.2, 12.0, 600.0);
        // 12 A for 600 s; rounding of 60,000 steps stays below 0.1 %.
        assert!(r.used.is_some_and(|used| (used - 7200.0).abs() < 7.2), "{r:?}");
        assert!((r.ratio - 15.2 / 14.8).abs() < 1e-4);
    }

    #[test]
    fn the_first_reading_starts_the_filter() {
        let r = Monitor::default().step(&Params::default(), Some(16.4), Some(0.5), 0.01);
        assert!(r.is_some_and(|r| (r.voltage - 16.4).abs() < 1e-5));
        assert!(
            Monitor::default()
                .step(&Params::default(), Some(f32::NAN), Some(0.5), 0.01)
                .is_none()
        );
    }

    #[test]
    fn the_ratio_stays_sane() {
        let mut m = Monitor::default();
        assert!((run(&mut m, 1.0, 0.0, 5.0).ratio - 0.7).abs() < 1e-6);
        assert!((run(&mut m, 50.0, 0.0, 5.0).ratio - 1.25).abs() < 1e-6);
    }

    #[test]
    fn the_ratio_takes_the_power_of_the_voltage() {
        let p = Params {
            thrust_volt_exp: 1.6,
            ..Params::default()
        };
        let battery = Monitor::default().step(&p, Some(13.3), None, 0.01).unwrap();
        assert!(
            (battery.ratio - (13.3f32 / 14.8).powf(0.8)).abs() < 1e-4,
            "{battery:?}"
        );
    }

    #[test]
    fn an_absurd_current_costs_the_current_and_the_voltage_goes_on() {
        let p = Params::default();
        // Torn off: 3.3 V at 100 A/V, and the rail.
        for absurd in [Some(330.0), Some(f32::NAN), reading(4095, 0.1)] {
            let mut m = Monitor::default();
            run(&mut m, 16.0, 12.0, 5.0);
            let mut step = |volts, current| m.step(&p, Some(volts), current, 0.01).unwrap();
            let before = step(16.0, Some(12.0));
            assert!(before.current.is_some_and(|i| (i - 12.0).abs() < 1e-3));
            let mut last = before;
            for _ in 0..500 {
                last = step(10.0, absurd);
            }
            assert!((last.voltage - 10.0).abs() < 0.01, "{last:?}");
            assert_eq!((last.current, last.used), (None, before.used));
            for _ in 0..500 {
                last = step(10.0, absurd);
            }
            assert_eq!(last.used, None, "a tenth of the charge may be missing by now");
            // From power-up.
            let first = Monitor::default().step(&p, Some(16.0), absurd, 0.01);
            assert!(first.is_some_and(|b| (b.voltage - 16.0).abs() < 1e-5));
        }
    }

    #[test]
    fn no_voltage_gives_no_battery_and_the_charge_is_counted_on() {
        let p = Params::default();
        for lost in [None, Some(f32::NAN), Some(-1.0), Some(70.0), reading(4095, 0.01)] {
            let mut m = Monitor::default();
            let used = run(&mut m, 16.0, 12.0, 5.0).used.unwrap();
            for _ in 0..100 {
                assert_eq!(m.step(&p, lost, Some(12.0), 0.01), None);
            }
            // The filter has a second to catch up, not one step.
            let again = m.step(&p, Some(12.0), Some(12.0), 0.01).unwrap();
            assert!((again.voltage - 12.3).abs() < 0.05, "{again:?}");
            assert!(again.used.is_some_and(|u| (u - used - 12.12).abs() < 0.01));
        }
        assert_eq!(reading(4089, 1.0), Some(4089.0));
    }

    #[test]
    fn the_servo_batterys_levels_outlast_a_closing_and_good_news_takes_them_back() {
        let (p, mut m) = (Params::default(), ServoMonitor::default());
        let mut run = |volts, seconds: f32| {
            let mut last = None;
            for _ in 0..(seconds * 100.0) as u32 {
                last = m.step(&p, Some(volts), 0.01);
            }
            last.unwrap().supply
        };
        assert_eq!(run(8.0, 10.0), ServoSupply::Good);
        // A closing of 3.9 s sags it by a volt.
        assert_eq!(run(6.7, 3.9), ServoSupply::Good);
        assert_eq!(run(7.9, 5.0), ServoSupply::Good);
        assert_eq!(run(7.1, 4.9), ServoSupply::Good);
        assert_eq!(run(7.1, 0.5), ServoSupply::NearEnd);
        assert_eq!(run(6.7, 4.9), ServoSupply::NearEnd);
        assert_eq!(run(6.7, 0.5), ServoSupply::Low);
        assert_eq!(run(8.2, 1.0), ServoSupply::Good);
        // No reading is no message, and one that is empty from the start is so at once.
        assert_eq!(m.step(&p, reading(4095, 0.01), 0.01), None);
        let first = ServoMonitor::default().step(&p, Some(0.1), 0.01);
        assert_eq!(first.map(|b| b.supply), Some(ServoSupply::Low));
    }

    proptest! {
        #[test]
        fn no_input_makes_a_bad_reading(
            inputs in proptest::collection::vec(
                (proptest::num::f32::ANY, proptest::num::f32::ANY, proptest::num::f32::ANY), 1..40),
        ) {
            let mut m = Monitor::default();
            for (v, i, dt) in inputs {
                if let Some(r) = m.step(&Params::default(), Some(v), Some(i), dt) {
                    prop_assert!([Some(r.voltage), r.current, r.used].into_iter().flatten().all(f32::is_finite));
                    prop_assert!((0.7..=1.25).contains(&r.ratio));
                }
            }
        }
    }
}
