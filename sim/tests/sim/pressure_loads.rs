//! `calibrate fsr` on simulated sensors: three known loads up and down on the mounted arm's pad, then a closing.

use sophie_control::calibration::Unfit;
use sophie_control::calibration::procedure::{Outcome, Procedure, Readings};
use sophie_control::calibration::step::{Calibration, Step};
use sophie_control::gripper::contact_pressure::{Fsr, FsrScale};
use sophie_control::gripper::grip::ArmState;
use sophie_control::params::Params;
use sophie_sim::plant::tendon::ServoProfile;
use sophie_sim::sensors::fsr::{FsrErrors, FsrSensor};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::arm_stand::{Closing, StandArm, try_grip};

/// Area of the sensor, m².
const AREA: f64 = 0.038 * 0.038;
/// Bend of an arm on the jig and on the pipe of 0.3 m, rad.
const BEND: f64 = 1.19;
/// Loads with the segment's own weight, kg, in the order of the steps.
const LOADS: [f64; 7] = [0.0, 0.1, 0.14, 0.2, 0.14, 0.1, 0.0];
/// Pressure of a grip, Pa.
const GRIP: f64 = 950.0;
const DT: f64 = 0.002;

/// A sensor on its arm, and the board's conversion with the parameters in force.
struct Pad {
    sensor: FsrSensor,
    fsr: Fsr,
    scale: FsrScale,
}

impl Pad {
    /// That of arm 1 of `streams`, with `gain` times the nominal conductance.
    fn new(streams: Streams, gain: f64, errors: FsrErrors) -> Self {
        let sensor = FsrSensor::new(0, streams);
        Self {
            sensor: sensor.with_fault(gain, None).with_errors(errors),
            fsr: Fsr::default(),
            scale: FsrScale::from_params(&Params::DEFAULT, 0),
        }
    }

    fn reads(&mut self, pressure: f64) -> f64 {
        let counts = self.sensor.sample(pressure, DT);
        f64::from(self.fsr.step(&self.scale, counts, DT as f32).unwrap())
    }

    /// A builder's loads, of which his scale shows `shown` kg: result with the parameters, and figures.
    fn calibrated(&mut self, shown: [f64; 7]) -> Result<(Params, [f32; 4]), Unfit> {
        let (mut procedure, mut now) = (Procedure::new(), 0u64);
        let mut params = Params::DEFAULT;
        self.sensor.bend(BEND);
        for (number, (load, shown)) in (1..).zip(LOADS.into_iter().zip(shown)) {
            // Hands take their time, and the load lies still.
            for _ in 0..(4.0 / DT) as u32 {
                self.reads(load * 9.806_65 / AREA);
            }
            let newton = (shown * 9.806_65) as f32;
            let step = Step::new(Calibration::Fsr, 1, number, [newton, 0.0]).unwrap();
            procedure.begin(step, now).unwrap();
            let finding = loop {
                now += 10_000;
                let mut pressure = 0.0;
                for _ in 0..5 {
                    pressure = self.reads(load * 9.806_65 / AREA) as f32;
                }
                let readings = Readings {
                    pressures: [Some(pressure), None, None, None],
                    ..Readings::default()
                };
                if let Some(finding) = procedure.sample(now, &readings, &Params::DEFAULT, &params) {
                    break finding;
                }
            };
            if let Outcome::Done(changes) = finding.result? {
                for (name, value) in changes.into_iter().flatten() {
                    params.set(name, value).unwrap();
                }
                return Ok((params, finding.figures));
            }
        }
        panic!("it wants more steps");
    }

    /// Mean readings with `params` at the grip pressure, after hours of rest: of rising pressure, in the half second of
    /// a proof, and a second after a fall from 1,300 Pa.
    fn closes(&mut self, params: &Params) -> [f64; 2] {
        self.sensor.bend(0.0);
        for _ in 0..3600 {
            self.sensor.sample(0.0, 1.0);
        }
        self.sensor.bend(BEND);
        self.scale = FsrScale::from_params(params, 0);
        [(0.0, GRIP), (1300.0, GRIP)].map(|(from, to)| {
            let mut sum = 0.0;
            for step in 0..1000 {
                let way = (f64::from(step) / 400.0).min(1.0);
                let reads = self.reads(from + way * (to - from));
                sum += if step >= 750 { reads } else { 0.0 };
            }
            sum / 250.0
        })
    }
}

/// What a builder's sensor may be, by docs/uncertainty.md.
fn drawn(seed: u64) -> (Pad, FsrErrors, f64) {
    let streams = Streams::new(seed);
    let within = |name: &str, low: f64, high: f64| streams.within(name, low, high);
    let errors = FsrErrors {
        turn_on: within("turn on", 0.1, 0.8),
        preload: within("preload", 0.0, 0.3),
        hysteresis: within("hysteresis", 0.05, 0.1),
        drift: within("drift", 0.03, 0.05),
        ..FsrErrors::default()
    };
    let gain = within("gain", 0.8, 1.2);
    (Pad::new(streams, gain, errors), errors, gain)
}

/// What a kitchen scale shows of the loads: 0.5 % off, and to 1 g.
fn weighed(seed: u64) -> [f64; 7] {
    let streams = Streams::new(seed);
    let scale = streams.within("scale", 0.995, 1.005);
    LOADS.map(|load| {
        let reading = streams.within(&format!("weight {load}"), -0.000_5, 0.000_5);
        if load > 0.0 {
            ((load * scale + reading) * 1e3).round() * 1e-3
        } else {
            0.0
        }
    })
}

/// The numbers of docs/uncertainty.md and docs/calibration.md.
#[test]
fn drawn_sensors_are_found_within_the_interval_that_is_stated() {
    let (mut off, mut within, mut hysteresis, mut slope) = (Vec::new(), 0, Vec::new(), Vec::new());
    let count = 400;
    for seed in 0..count {
        let (mut pad, truth, gain) = drawn(seed);
        let (params, [error, width, empty, _]) = pad.calibrated(weighed(seed)).unwrap();
        let [rising, falling] = pad.closes(&params);
        let reads = 0.5 * (rising + falling);
        off.push(reads - GRIP);
        within += i32::from((reads - GRIP).abs() <= f64::from(error));
        hysteresis.push(f64::from(width) - 100.0 * truth.hysteresis);
        slope.push(f64::from(params.fsr_trim_1) / gain);
        assert!(
            (47.0..90.0).contains(&error) && empty < 120.0,
            "{seed}: {error} {empty}"
        );
    }
    // A proof comes a second after the touch, the loads lie for six: it reads 2 % less by the drift, 0.5 to 4.6 % less
    // in 95 of 100.
    let [least, most] = ends(&mut off).map(|pascal| pascal / GRIP);
    assert!(
        (-0.055..-0.04).contains(&least) && (-0.01..0.0).contains(&most),
        "{least} {most}"
    );
    assert!(f64::from(within) >= 0.95 * count as f64, "{within} of {count}");
    // The drift of the rising loads adds to those that fall.
    let [least, most] = ends(&mut hysteresis);
    assert!(
        (0.0..1.2).contains(&least) && (2.5..4.0).contains(&most),
        "{least} {most}"
    );
    // The parts' own 5 % are in it.
    let [least, most] = ends(&mut slope);
    assert!(
        (0.96..1.02).contains(&least) && (1.09..1.16).contains(&most),
        "{least} {most}"
    );
}

/// The ends of 95 of 100 of `values`.
fn ends(values: &mut [f64]) -> [f64; 2] {
    values.sort_by(f64::total_cmp);
    [0.025, 0.975].map(|share| values[((values.len() - 1) as f64 * share) as usize])
}

/// As before: a sound sensor without drift is found as it is, by exact loads.
#[test]
fn a_sound_sensor_is_found_as_it_is() {
    let errors = FsrErrors {
        hysteresis: 0.0,
        ..FsrErrors::default()
    };
    let mut pad = Pad::new(Streams::new(3), 1.0, errors);
    let (params, [_, hysteresis, empty, _]) = pad.calibrated(LOADS).unwrap();
    assert!(
        params.fsr_zero_1.abs() < 40.0 && hysteresis.abs() < 2.0 && empty < 20.0,
        "{params:?}"
    );
    for reads in pad.closes(&params) {
        assert!((reads - GRIP).abs() < 0.03 * GRIP, "{reads}");
    }
}

#[test]
fn a_sensor_that_sticks_or_creeps_is_refused_with_the_number() {
    let refused = |errors| {
        let mut pad = Pad::new(Streams::new(3), 1.0, errors);
        pad.calibrated(LOADS).unwrap_err().what
    };
    let sound = FsrErrors::default();
    let wide = FsrErrors {
        hysteresis: 0.16,
        ..sound
    };
    let wider = FsrErrors {
        hysteresis: 0.3,
        ..sound
    };
    let late = FsrErrors {
        turn_on: 1.2,
        ..sound
    };
    assert_eq!(refused(wide), "half width of hysteresis");
    assert_eq!(refused(wider), "reading's change per load");
    assert_eq!(refused(late), "reading of the load");
}

/// A gripper that reads by the line closes as with a sound sensor; without it, it presses by the turn-on force more.
#[test]
fn an_arm_with_a_late_sensor_closes_by_its_line() {
    let stand = |fsr: FsrErrors, zero: f32, trim: f32| {
        let mut arm = StandArm::from(&Closing {
            infill: 6.0,
            diameter: 0.3,
            servo: ServoProfile::Paper.into(),
            thrust: 2.5,
            seconds: 10.0,
            seed: 1,
        });
        arm.fsr = fsr;
        (arm.params.fsr_zero_1, arm.params.fsr_trim_1) = (zero, trim);
        try_grip(&arm, 10.0)
    };
    let sound = stand(FsrErrors::default(), 0.0, 1.0);
    for turn_on in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8] {
        let late = FsrErrors {
            turn_on,
            hysteresis: 0.05,
            ..FsrErrors::default()
        };
        let by_line = stand(late, (-turn_on / AREA) as f32, 1.0);
        assert!(
            by_line.grip.state == ArmState::Holding && by_line.grip.fault.is_none(),
            "{turn_on}: {by_line:?}"
        );
        // As with a sound sensor but for its hysteresis of 5 %, which the proof reads too little.
        assert!(
            (by_line.steady / sound.steady - 0.99).abs() < 0.02,
            "{turn_on}: {by_line:?}"
        );
        assert!(by_line.peak < 1.05 * sound.peak, "{turn_on}: {by_line:?}");
        let without = stand(late, 0.0, 1.0);
        let more = without.peak - by_line.peak;
        assert!((more - turn_on / AREA).abs() < 120.0, "{turn_on}: {more}");
    }
}
