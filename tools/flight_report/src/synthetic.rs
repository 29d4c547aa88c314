//! A synthetic flight for tests of the reports.

use std::f64::consts::TAU;

use sophie_control::mode::Mode;
use sophie_sim::record::{
    Ended, Event, FlightRecord, Grip, Outcome, Phase, SAMPLE_HZ, Sample, Strike, Struck, Verdict,
};
use sophie_sim::scenario::{Rule, Scenario, Step};

/// Durations of the default mission's steps, s.
const DURATIONS: [f64; 12] = [3.5, 4.0, 5.0, 4.5, 5.5, 4.0, 6.5, 20.0, 6.0, 5.0, 6.0, 1.5];

/// A flight of the default mission.
pub fn record() -> FlightRecord {
    let scenario = Scenario::default_mission();
    let mut phases = Vec::new();
    let mut start = 0.0;
    for (step, duration) in scenario.steps.iter().zip(DURATIONS) {
        phases.push(Phase {
            name: step.name().to_owned(),
            start,
            end: start + duration,
            done: true,
            worst_attitude_error: 0.02 + 0.01 * duration,
            worst_tilt: -0.1 - 0.02 * duration,
            saturation: if matches!(step, Step::Roll { .. }) {
                0.034
            } else {
                0.0
            },
            battery_voltage: 16.4 - 0.01 * start,
            overruns: 0,
        });
        start += duration;
    }
    let samples = (0..(start * SAMPLE_HZ) as usize)
        .map(|i| sample(i as f64 / SAMPLE_HZ, &phases))
        .collect();
    let event = |t, text: &str| Event {
        t,
        text: text.to_owned(),
    };
    let closure = [2.61, 2.83, 3.65, 3.85];
    let torque = [0.39, 0.51, 0.81, 0.90];
    FlightRecord {
        outcome: Outcome {
            accomplished: true,
            ended: Ended::Done,
            reason: "mission accomplished".to_owned(),
        },
        verdicts: Rule::WORDS
            .iter()
            .map(|word| Verdict {
                rule: Rule::from_word(word),
                fault: None,
            })
            .collect(),
        samples,
        events: vec![
            event(2.0, "calibrated: gyro bias 0.31 0.12 -0.20 deg/s"),
            event(3.4, "armed"),
            event(26.6, "contact: pipe felt by 4 arms <&\">"),
            event(31.9, "grip proven on arms 1 2 3 4"),
            event(64.9, "disarmed"),
        ],
        grip: (0..4_u8)
            .map(|i| Grip {
                arm: i + 1,
                pressure: 950.0 + 9.0 * f64::from(i),
                pressure_true: 944.0 + 12.0 * f64::from(i),
                torque: torque[usize::from(i)],
                closure: closure[usize::from(i)],
            })
            .collect(),
        strikes: vec![Strike {
            arm: 2,
            against: Struck::Pipe,
            start: 31.2,
            end: 31.24,
            depth: 0.012,
        }],
        sim_seconds: start,
        wall_seconds: 0.21,
        overruns: 0,
        digest: 0x0123_4567_89ab_cdef,
        phases,
        scenario,
    }
}

/// Where the flight is.
struct Course {
    mode: Mode,
    /// m.
    height: f64,
    /// Distance north, m.
    north: f64,
    /// How far the arms are closed, 0 to 1.
    closed: f64,
    /// Mean of the rotors, N.
    thrust: f64,
}

/// At `t` s, the share `u` of step `index`.
fn course(t: f64, index: usize, u: f64) -> Course {
    let ramp = |a: f64, b: f64| a + (b - a) * u * u * (3.0 - 2.0 * u);
    let at = |mode, height, north, closed, thrust| Course {
        mode,
        height,
        north,
        closed,
        thrust,
    };
    match index {
        0 if t < 2.0 => at(Mode::Calibrating, 0.04, 0.0, 0.0, 0.0),
        0 => at(Mode::Disarmed, 0.04, 0.0, 0.0, 0.0),
        1 => at(Mode::Flight, ramp(0.04, 3.0), 0.0, 0.0, 4.5),
        2 | 3 => at(Mode::Flight, 3.0, 0.0, 0.0, 4.43),
        4 => at(Mode::Flight, ramp(3.0, 2.5), ramp(0.0, 3.0), 0.0, 4.4),
        5 => at(Mode::Flight, ramp(2.5, 1.54), 3.0, 0.0, 4.3),
        6 if u < 0.2 => at(Mode::Contact, 1.54, 3.0, 0.0, 2.5),
        6 => at(Mode::Clamping, 1.54, 3.0, ((u - 0.2) / 0.55).min(1.0), 2.5),
        7 => at(Mode::Perched, 1.54, 3.0, 1.0, 0.0),
        8 => at(
            Mode::Releasing,
            ramp(1.54, 2.54),
            3.0,
            (1.0 - u * 2.0).max(0.0),
            4.5,
        ),
        9 => at(Mode::Flight, ramp(2.54, 2.0), ramp(3.0, 0.0), 0.0, 4.4),
        10 => at(Mode::Landed, ramp(2.0, 0.04), 0.0, 0.0, 4.3),
        _ => at(Mode::Disarmed, 0.04, 0.0, 0.0, 0.0),
    }
}

fn sample(t: f64, phases: &[Phase]) -> Sample {
    let index = phases.iter().position(|p| t < p.end).unwrap_or(phases.len() - 1);
    let u = (t - phases[index].start) / (phases[index].end - phases[index].start);
    let noise = |k: f64| (t * 37.0 * k).sin() * (t * 91.7 + k).sin();
    let Course {
        mode,
        height,
        north,
        closed,
        thrust: mean,
    } = course(t, index, u);
    let roll_target = if index == 3 {
        0.436 * (u * TAU).sin().signum()
    } else {
        0.0
    };
    let roll = if index == 3 {
        0.43 * (u * TAU).sin().cbrt()
    } else {
        0.01 * noise(1.0)
    };
    let free = (mean - 4.2) * 0.12;
    let per_arm = |f: &dyn Fn(f64, f64) -> f64| [f(1.0, 0.0), f(1.0, 1.0), f(-1.0, 2.0), f(-1.0, 3.0)];
    let tilt =
        per_arm(&|side, k| free * (1.0 - closed) - 0.95 * closed + side * roll * 0.4 + 0.01 * noise(k + 2.0));
    let thrust =
        per_arm(&|side, k| (mean + side * 2.0 * (roll_target - roll) + 0.1 * noise(k)).clamp(0.0, 8.3));
    let force = per_arm(&|_, k| closed * (26.0 + 11.0 * k));
    let pressure = per_arm(&|_, k| 950.0 * ((closed * 1.4 - 0.4).max(0.0) + 0.01 * noise(k) * closed));
    Sample {
        t,
        mode,
        position: [north, 0.02 * noise(0.3), -height],
        velocity: [0.0; 3],
        attitude: [roll, 0.02 * noise(0.7), 0.03 * noise(0.2)],
        attitude_estimate: [roll + 0.004, 0.02 * noise(0.7) + 0.003, 0.03 * noise(0.2)],
        attitude_setpoint: if mean > 0.0 {
            [roll_target, 0.0, 0.0]
        } else {
            [f64::NAN; 3]
        },
        rate: [0.0; 3],
        tilt,
        tilt_measured: tilt.map(|a| a + 0.01 * noise(5.0)),
        tilt_model: tilt.map(|a| if closed > 0.0 { free } else { a * 0.95 }),
        thrust,
        thrust_asked: thrust.map(|v| v + 0.1),
        tension: force,
        tension_asked: force.map(|f| f * 1.02),
        pressure,
        pressure_measured: if t > 0.0 {
            pressure.map(|p| p + 25.0 * noise(6.0) * closed)
        } else {
            [f64::NAN; 4]
        },
        battery_voltage: 16.6 - 0.012 * t - 0.08 * mean,
        throttle: mean / 8.3,
        saturated: index == 3 && u < 0.03,
        position_estimate: None,
        pose: None,
        range: height,
        range_measured: None,
        flow: None,
    }
}
