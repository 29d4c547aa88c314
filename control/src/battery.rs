//! Flight battery from voltage and current.
//!
//! [`Monitor::step`] runs at 100 Hz in the task `analog` (V, A, s). After a missed reading thrusts are compensated for
//! the last voltage; it is stale after 500 ms.

use crate::filter::LowPass;
use crate::math;
use crate::params::Params;

/// Cut-off of the voltage, rad/s (2 Hz): between a manoeuvre's sag and the discharge.
const VOLTAGE_CUTOFF: f32 = 12.6;
/// Cut-off of the current, rad/s (2 Hz).
const CURRENT_CUTOFF: f32 = 12.6;
/// Bounds of the thrust curve's voltage ratio: 4S from 10.4 to 18.5 V.
const RATIO_BOUNDS: (f32, f32) = (0.7, 1.25);
/// Largest plausible readings: V, A.
const SANE: (f32, f32) = (60.0, 300.0);

/// Measured state of the flight battery.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Battery {
    /// Voltage under load, V, low-passed.
    pub voltage: f32,
    /// Current, A, low-passed.
    pub current: f32,
    /// Charge drawn since power-up, A·s.
    pub used: f32,
    /// Voltage over nominal, bounded: compensates the thrust curve.
    pub ratio: f32,
}

/// The battery's filters and counters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Monitor {
    filters: Option<(LowPass, LowPass)>,
    used: f32,
    /// Charge not yet in `used`, A·s.
    fraction: f32,
}

impl Monitor {
    /// Adds `voltage` V and `current` A, `dt` s after the last. Implausible values are ignored; `None` before the first
    /// plausible ones.
    pub fn step(&mut self, p: &Params, voltage: f32, current: f32, dt: f32) -> Option<Battery> {
        let dt = math::clamp(dt, 0.0, 1.0);
        let sane = (0.0..SANE.0).contains(&voltage) && (-SANE.1..SANE.1).contains(&current);
        if sane {
            let (v, i) = self
                .filters
                .get_or_insert((LowPass::at(voltage), LowPass::at(current)));
            v.step(voltage, VOLTAGE_CUTOFF, dt);
            let filtered = i.step(current, CURRENT_CUTOFF, dt);
            self.add_charge(filtered * dt);
        }
        self.filters.map(|(v, i)| Battery {
            voltage: v.value(),
            current: i.value(),
            used: self.used + self.fraction,
            ratio: math::clamp(v.value() / p.battery_nominal, RATIO_BOUNDS.0, RATIO_BOUNDS.1),
        })
    }

    /// Adds charge in portions of 1 A·s: 10 ms of 1 A would vanish beside 6000 A·s in an `f32`.
    fn add_charge(&mut self, charge: f32) {
        self.fraction += charge;
        if self.fraction.abs() > 1.0 {
            self.used = math::clamp(self.used + self.fraction, 0.0, 1e7);
            self.fraction = 0.0;
        }
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
            last = m.step(&p, voltage, current, 0.01).unwrap_or_default();
        }
        last
    }

    #[test]
    fn charge_adds_up() {
        let r = run(&mut Monitor::default(), 15.2, 12.0, 600.0);
        // 12 A for 600 s; rounding of 60,000 steps stays below 0.1 %.
        assert!((r.used - 7200.0).abs() < 7.2, "{}", r.used);
        assert!((r.ratio - 15.2 / 14.8).abs() < 1e-4);
    }

    #[test]
    fn the_first_reading_starts_the_filter() {
        let r = Monitor::default().step(&Params::default(), 16.4, 0.5, 0.01);
        assert!(r.is_some_and(|r| (r.voltage - 16.4).abs() < 1e-5));
        assert!(
            Monitor::default()
                .step(&Params::default(), f32::NAN, 0.5, 0.01)
                .is_none()
        );
    }

    #[test]
    fn the_ratio_stays_sane() {
        let mut m = Monitor::default();
        assert!((run(&mut m, 1.0, 0.0, 5.0).ratio - 0.7).abs() < 1e-6);
        assert!((run(&mut m, 50.0, 0.0, 5.0).ratio - 1.25).abs() < 1e-6);
    }

    proptest! {
        #[test]
        fn no_input_makes_a_bad_reading(
            inputs in proptest::collection::vec(
                (proptest::num::f32::ANY, proptest::num::f32::ANY, proptest::num::f32::ANY), 1..40),
        ) {
            let mut m = Monitor::default();
            for (v, i, dt) in inputs {
                if let Some(r) = m.step(&Params::default(), v, i, dt) {
                    prop_assert!(r.voltage.is_finite() && r.current.is_finite() && r.used.is_finite());
                    prop_assert!((0.7..=1.25).contains(&r.ratio));
                }
            }
        }
    }
}
