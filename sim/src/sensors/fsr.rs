//! A force-sensing resistor under an arm's skin, with divider and converter.
//!
//! Interlink FSR 406 after datasheet and integration guide: no conductance below 0.1 N, then about proportional to
//! force (10 kΩ at 1 N), with part-to-part spread, hysteresis and creep: in all the paper's error of about 50 N/m² at
//! 950 N/m².

use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use crate::normal::StandardNormal;
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
    force: f64,
    creep: f64,
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
            force: 0.0,
            creep: 0.0,
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
        let force = pressure.max(0.0) * AREA;
        // Hysteresis as play: the sensed force moves only when the true one leaves the band around it.
        self.force = self
            .force
            .clamp(force * (1.0 - HYSTERESIS), force * (1.0 + HYSTERESIS));
        let keep = libm::exp(-dt / CREEP.1);
        self.creep = self.creep * keep + CREEP.0 * (1.0 - keep * keep).sqrt() * normal();
        let x = match self.broken {
            Some(FsrBreak::Open) => 0.0,
            Some(FsrBreak::Short) => 1.0,
            None | Some(FsrBreak::Stuck) if force < THRESHOLD => 0.0,
            None | Some(FsrBreak::Stuck) => {
                let drift = 1.0 + self.creep + NOISE * normal();
                let load = self.gain * libm::pow(self.force, self.exponent) * drift * self.divider;
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
