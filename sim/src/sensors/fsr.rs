//! A force-sensing resistor under an arm's skin, with divider and converter.
//!
//! Interlink FSR 406 after datasheet and integration guide: no conductance below 0.1 N, then about proportional to
//! force (10 kΩ at 1 N), with part-to-part spread, hysteresis and creep: in all the paper's error of about 50 N/m² at
//! 950 N/m².
//!
//! [`FsrErrors`] adds those of a sensor in a curved skin, off by default: the conductance is
//! G = g (1 + e) F_e^n (1 + c_T (T − 23 °C)), F_e = max(0, F + F_p − F_0), of the force F on the pad, the preload F_p by
//! the skin's curvature and the turn-on force F_0; it drifts upwards by a share of itself per decade of time.

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use crate::normal::StandardNormal;
use crate::plant::creep::Creep;
use crate::streams::Streams;

/// Area, m²: 38 mm square (datasheet).
const AREA: f64 = 0.038 * 0.038;
/// Threshold, N (datasheet).
const THRESHOLD: f64 = 0.1;
/// Conductance at 1 N, S (guide, about 10 kΩ).
const GAIN: f64 = 1e-4;
/// Largest gain error, calibrated in the arm (assumed; 6 % from the reel, datasheet).
const PART_ERROR: f64 = 0.04;
/// Smallest exponent of the force, up to 1 (assumed; the guide's log-log plot is straight near 1).
const EXPONENT_MIN: f64 = 0.97;
/// Half width of the hysteresis over force (assumed for slow changes; datasheet 10 % over the whole range).
const HYSTERESIS: f64 = 0.015;
/// Creep: RMS share and time constant, s (assumed; datasheet below 5 % per decade of time).
const CREEP: (f64, f64) = (0.008, 20.0);
/// RMS noise over the conductance (assumed).
const NOISE: f64 = 0.004;
/// Resistor to ground, Ω, and its largest error.
const DIVIDER: (f64, f64) = (10_000.0, 0.01);
/// RMS noise of the converter, counts.
const ADC_NOISE: f64 = 1.2;

/// Largest relative error of the pressure: limits of gain and divider, hysteresis, three times the creep's RMS, and 1 %
/// by the exponent at the grip pressure. Sum 9.9 %, 94 Pa at 950 Pa; the paper's 50 Pa may be typical or largest.
pub const LARGEST_ERROR: f64 = PART_ERROR + DIVIDER.1 + HYSTERESIS + 3.0 * CREEP.0 + 0.01;

/// Time from which the drift of a loaded sensor counts, s (Interlink's guide plots from 0.1 s).
const DRIFT_BEGIN: f64 = 0.1;

/// Errors of a sensor in its skin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FsrErrors {
    /// Turn-on force F_0, N, in place of the threshold; 0: the conductance is that of the whole force above 0.1 N.
    /// 0.2 N (data sheet), break force 20 to 100 g (guide).
    pub turn_on: f64,
    /// Preload by the arm's curvature, N per radian of tilt (curvature shifts the calibration: Schofield, PMC5903557).
    pub preload: f64,
    /// Half width of the hysteresis over force; 10 % (data sheet), Preisach-like (Paredes-Madrid 2018).
    pub hysteresis: f64,
    /// Drift, share of the force per decade of time since loaded; below 5 % (data sheet, 1 kg for 35 days).
    pub drift: f64,
    /// Conductance at the day's temperature over that at 23 °C.
    pub warmth: f64,
    /// Force on the pad over its area times the pressure: it measures only what touches it.
    pub pad_share: f64,
}

impl Default for FsrErrors {
    fn default() -> Self {
        Self {
            turn_on: 0.0,
            preload: 0.0,
            hysteresis: HYSTERESIS,
            drift: 0.0,
            warmth: 1.0,
            pad_share: 1.0,
        }
    }
}

/// A fault of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FsrBreak {
    /// Open lead.
    Open,
    /// Shorted leads.
    Short,
    /// It repeats its last reading.
    Stuck,
}

/// One sensor with its divider.
#[derive(Clone, Debug)]
pub struct FsrSensor {
    gain: f64,
    exponent: f64,
    divider: f64,
    errors: FsrErrors,
    /// Bend of the skin, rad.
    bend: f64,
    force: f64,
    creep: f64,
    drift: Creep,
    broken: Option<FsrBreak>,
    /// Fault to come, and its begin, s after power-up.
    breaks: Option<(FsrBreak, f64)>,
    /// Time, s.
    time: f64,
    counts: u16,
    rng: Pcg64Mcg,
}

impl FsrSensor {
    /// The sensor of `arm`, 0 to 3, with the errors of `streams`.
    #[must_use]
    pub fn new(arm: usize, streams: Streams) -> Self {
        let within =
            |what: &str, low: f64, high: f64| streams.within(&format!("fsr.{}.{what}", arm + 1), low, high);
        Self {
            gain: GAIN * within("gain", 1.0 - PART_ERROR, 1.0 + PART_ERROR),
            exponent: within("exponent", EXPONENT_MIN, 1.0),
            divider: DIVIDER.0 * within("divider", 1.0 - DIVIDER.1, 1.0 + DIVIDER.1),
            errors: FsrErrors::default(),
            bend: 0.0,
            force: 0.0,
            creep: 0.0,
            drift: Creep::new(0.0, DRIFT_BEGIN),
            broken: None,
            breaks: None,
            time: 0.0,
            counts: 0,
            rng: streams.of(&format!("fsr.{}", arm + 1)),
        }
    }

    /// The same with its gain multiplied by `gain`, and with a fault from a time, s after power-up, on.
    #[must_use]
    pub fn with_fault(mut self, gain: f64, fault: Option<(FsrBreak, f64)>) -> Self {
        self.gain *= gain;
        self.breaks = fault;
        self
    }

    /// The same with `errors`.
    #[must_use]
    pub fn with_errors(self, errors: FsrErrors) -> Self {
        Self {
            errors,
            drift: Creep::new(errors.drift, DRIFT_BEGIN),
            ..self
        }
    }

    /// Bends the skin to the arm's `tilt`, rad.
    pub fn bend(&mut self, tilt: f64) {
        self.bend = tilt.abs();
    }

    /// Sets or clears a fault.
    pub fn set_broken(&mut self, broken: Option<FsrBreak>) {
        self.broken = broken;
    }

    /// 12-bit counts at the true `pressure` (Pa), `dt` s after the last sample.
    pub fn sample(&mut self, pressure: f64, dt: f64) -> u16 {
        self.time += dt;
        if let Some((broken, at)) = self.breaks
            && self.time >= at
        {
            self.broken = Some(broken);
        }
        if self.broken != Some(FsrBreak::Stuck) {
            self.counts = self.measure(pressure, dt);
        }
        self.counts
    }

    fn measure(&mut self, pressure: f64, dt: f64) -> u16 {
        let rng = &mut self.rng;
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let FsrErrors {
            turn_on,
            preload,
            hysteresis,
            warmth,
            pad_share,
            ..
        } = self.errors;
        let force = pressure.max(0.0) * AREA * pad_share + preload * self.bend;
        // Hysteresis as play: the sensed force moves only when the true one leaves the band around it.
        self.force = self
            .force
            .clamp(force * (1.0 - hysteresis), force * (1.0 + hysteresis));
        let above = (self.force - turn_on).max(0.0);
        let conducts = if turn_on > 0.0 {
            above > 0.0
        } else {
            force >= THRESHOLD
        };
        let drifted = self.drift.step(dt, above);
        let keep = libm::exp(-dt / CREEP.1);
        self.creep = self.creep * keep + CREEP.0 * (1.0 - keep * keep).sqrt() * normal();
        let x = match self.broken {
            Some(FsrBreak::Open) => 0.0,
            Some(FsrBreak::Short) => 1.0,
            None | Some(FsrBreak::Stuck) if !conducts => 0.0,
            None | Some(FsrBreak::Stuck) => {
                let drift = 1.0 + self.creep + NOISE * normal();
                let load =
                    self.gain * libm::pow(above + drifted, self.exponent) * drift * self.divider * warmth;
                load / (1.0 + load)
            }
        };
        // Divider noise; a grounded or railed pin has none.
        let noise = if x > 0.0 && x < 1.0 {
            ADC_NOISE * normal()
        } else {
            0.0
        };
        (x * 4095.0 + noise).round().clamp(0.0, 4095.0) as u16
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_at_the_grip_pressure_is_the_paper_s() {
        let (mut square, mut worst) = (0.0, 0.0_f64);
        let n = 400;
        for seed in 0..n {
            let mut s = FsrSensor::new(0, Streams::new(seed));
            let mut counts = 0.0;
            for i in 0..500 {
                let p = 950.0 * (f64::from(i) / 300.0).min(1.0);
                counts = f64::from(s.sample(p, 0.002));
            }
            let x = counts / 4095.0;
            let error = x / (1.0 - x) / 10_000.0 / 1e-4 / AREA - 950.0;
            square += error * error;
            worst = worst.max(error.abs());
        }
        let rms = (square / n as f64).sqrt();
        assert!(
            (20.0..40.0).contains(&rms) && (50.0..950.0 * LARGEST_ERROR).contains(&worst),
            "{rms} {worst}"
        );
    }

    #[test]
    fn it_reads_nothing_below_its_threshold_and_has_hysteresis() {
        let mut s = FsrSensor::new(0, Streams::new(3));
        assert!(s.sample(60.0, 0.002) == 0);
        let mut mean = |p: f64| (0..2000).map(|_| f64::from(s.sample(p, 0.0))).sum::<f64>() / 2000.0;
        let up = mean(900.0);
        mean(1500.0);
        let down = mean(900.0);
        assert!(down > up + 20.0, "{up} {down}");
    }

    /// Mean force that `sensor` reads under `pressure` for `seconds`, N, after it has settled, by its nominal gain.
    fn reads(sensor: &mut FsrSensor, pressure: f64, seconds: f64) -> f64 {
        let samples = (seconds / 0.02) as u32;
        let mut sum = 0.0;
        for sample in 0..samples {
            let x = f64::from(sensor.sample(pressure, 0.02)) / 4095.0;
            sum += if 2 * sample >= samples { x / (1.0 - x) } else { 0.0 };
        }
        2.0 * sum / f64::from(samples) / 10_000.0 / GAIN
    }

    fn with(errors: FsrErrors) -> FsrSensor {
        FsrSensor::new(0, Streams::new(3)).with_errors(errors)
    }

    const SOUND: FsrErrors = FsrErrors {
        turn_on: 0.0,
        preload: 0.0,
        hysteresis: 0.0,
        drift: 0.0,
        warmth: 1.0,
        pad_share: 1.0,
    };

    #[test]
    fn a_turn_on_force_is_missing_at_every_pressure_and_a_preload_reads_without_any() {
        let loss = |pressure| {
            let turn_on = FsrErrors {
                turn_on: 0.3,
                ..SOUND
            };
            reads(&mut with(SOUND), pressure, 4.0) - reads(&mut with(turn_on), pressure, 4.0)
        };
        // 0.3 N less, within gain, exponent and noise: 208 Pa.
        assert!((loss(600.0) - 0.3).abs() < 0.02 && (loss(1200.0) - 0.3).abs() < 0.02);
        let mut late = with(FsrErrors {
            turn_on: 0.3,
            ..SOUND
        });
        assert_eq!(late.sample(200.0, 0.02), 0);
        assert!(late.sample(220.0, 0.02) > 0);
        let mut curved = with(FsrErrors {
            preload: 0.2,
            ..SOUND
        });
        assert_eq!(curved.sample(0.0, 0.02), 0);
        curved.bend(-1.2);
        assert!((reads(&mut curved, 0.0, 4.0) - 0.24).abs() < 0.02);
    }

    #[test]
    fn a_loaded_sensor_drifts_upwards_by_decades_and_recovers() {
        let mut sensor = with(FsrErrors { drift: 0.04, ..SOUND });
        let (early, late) = (reads(&mut sensor, 950.0, 10.0), reads(&mut sensor, 950.0, 990.0));
        // Means of 5 to 10 s and 505 to 1000 s: 4 % · log10(750/7.5); the zero-mean creep has 0.8 %.
        assert!((late / early - 1.08).abs() < 0.02, "{early} {late}");
        reads(&mut sensor, 0.0, 3600.0);
        let again = reads(&mut sensor, 950.0, 10.0);
        assert!(again < 0.5 * (early + late), "{early} {late} {again}");
    }

    #[test]
    fn a_wide_hysteresis_a_small_contact_and_a_warm_day_change_the_reading_by_their_share() {
        let wide = |pressures: [f64; 2]| {
            let mut sensor = with(FsrErrors {
                hysteresis: 0.1,
                ..SOUND
            });
            pressures.map(|pressure| reads(&mut sensor, pressure, 2.0))[1]
        };
        let (up, down) = (wide([0.0, 950.0]), wide([2000.0, 950.0]));
        assert!((down / up - 1.1 / 0.9).abs() < 0.03, "{up} {down}");
        let share = |errors| reads(&mut with(errors), 950.0, 2.0) / reads(&mut with(SOUND), 950.0, 2.0);
        let (pad, warm) = (
            share(FsrErrors {
                pad_share: 0.8,
                ..SOUND
            }),
            share(FsrErrors {
                warmth: 0.97,
                ..SOUND
            }),
        );
        assert!(
            (pad - 0.8).abs() < 0.01 && (warm - 0.97).abs() < 0.01,
            "{pad} {warm}"
        );
    }

    #[test]
    fn broken_leads() {
        let mut s = FsrSensor::new(0, Streams::new(3));
        s.set_broken(Some(FsrBreak::Open));
        assert!(s.sample(950.0, 0.002) == 0);
        s.set_broken(Some(FsrBreak::Short));
        assert!(s.sample(950.0, 0.002) == 4095);
        s.set_broken(None);
        let before = s.sample(950.0, 0.002);
        s.set_broken(Some(FsrBreak::Stuck));
        assert!(before > 1000 && (0..100).all(|_| s.sample(0.0, 0.002) == before));
    }

    #[test]
    fn a_fault_begins_when_it_is_due_and_a_wrong_gain_at_once() {
        let sound = || FsrSensor::new(2, Streams::new(3));
        let mut s = sound().with_fault(0.5, Some((FsrBreak::Open, 1.0)));
        let half = s.sample(950.0, 0.5);
        assert!(half < sound().sample(950.0, 0.5) && half > 500, "{half}");
        assert!(s.sample(950.0, 0.4) > 0);
        assert_eq!(s.sample(950.0, 0.2), 0);
        let mut other = FsrSensor::new(1, Streams::new(3)).with_fault(1.0, None);
        assert!(other.sample(950.0, 2.0) > 1000);
    }
}
