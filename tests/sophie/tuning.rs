//! The table of symptoms in docs/tuning.md is flown.

use std::f64::consts::TAU;
use std::fmt::Write;

use sophie_sim::flight;
use sophie_sim::record::{FlightRecord, SAMPLE_HZ, Sample, Silent};
use sophie_sim::scenario::{Scenario, Step};

/// Height from which on the vehicle counts as in the air, m, and the time that is looked at from there, s.
const AIRBORNE: f64 = 0.3;
const WINDOW: usize = 10 * SAMPLE_HZ as usize;
/// Frequencies that are looked for, Hz.
const FROM: f64 = 0.25;
const STEP: f64 = 0.25;
const COUNT: u32 = 80;

/// A vehicle with something wrong with it, and what the pilot sees of it.
struct Case {
    what: &'static str,
    seen: &'static str,
    change: fn(&mut Scenario),
}

const CASES: [Case; 10] = [
    Case {
        what: "as it should be",
        seen: "nothing",
        change: |_| (),
    },
    Case {
        what: "`rate_pitch_p` 32, too high",
        seen: "shakes as soon as it lifts",
        change: |s| s.params.rate_pitch_p = 32.0,
    },
    Case {
        what: "`rate_pitch_p` 3, too low",
        seen: "swings slowly, follows late",
        change: |s| s.params.rate_pitch_p = 3.0,
    },
    Case {
        what: "`rate_pitch_i` 90, too high",
        seen: "swings, faster than by hand",
        change: |s| s.params.rate_pitch_i = 90.0,
    },
    Case {
        what: "`attitude_p` 10, too high",
        seen: "nods after each stick",
        change: |s| s.params.attitude_p = 10.0,
    },
    Case {
        what: "`estimator_kp` 2, too high",
        seen: "swims about",
        change: |s| s.params.estimator_kp = 2.0,
    },
    Case {
        what: "motors slower than `motor_tau`: 0.12 s",
        seen: "nothing at these gains; less room above",
        change: |s| s.vehicle.rotor.spin.up = 0.12,
    },
    Case {
        what: "rotors weaker than `thrust_max`: 6.5 N",
        seen: "hovers at more throttle",
        change: |s| s.vehicle.rotor.thrust_max = 6.5,
    },
    Case {
        what: "arms level at 60 % of thrust, `arm_level_share` 0.5",
        seen: "nothing: the sensors take it out",
        change: |s| s.vehicle.arm_level_share = 0.6,
    },
    Case {
        what: "arms of 6 % infill, `infill` 8",
        seen: "nothing: near level in hover at any infill",
        change: |s| {
            s.vehicle.infill = 6.0;
            s.params.infill = 8.0;
        },
    },
];

/// Size (root mean square) of a signal's swing, and the frequency that most of it has, Hz.
struct Swing {
    size: f64,
    hz: f64,
}

fn swing(signal: &[f64]) -> Swing {
    let n = signal.len().max(1) as f64;
    let mean = signal.iter().sum::<f64>() / n;
    let power = |hz: f64| {
        let sum = signal.iter().enumerate().fold((0.0, 0.0), |(re, im), (i, x)| {
            let phase = TAU * hz * i as f64 / SAMPLE_HZ;
            (re + (x - mean) * phase.cos(), im + (x - mean) * phase.sin())
        });
        sum.0 * sum.0 + sum.1 * sum.1
    };
    let all = (0..COUNT).map(|i| FROM + STEP * f64::from(i));
    let hz = all
        .max_by(|a, b| power(*a).total_cmp(&power(*b)))
        .unwrap_or_default();
    let square: f64 = signal.iter().map(|x| (x - mean).powi(2)).sum();
    Swing {
        size: (square / n).sqrt(),
        hz,
    }
}

/// Up, a hover, a roll either way, a hover, down.
fn flown(case: &Case) -> FlightRecord {
    let mut scenario = Scenario {
        steps: vec![
            Step::Arm,
            Step::TakeOff { height: 2.0 },
            Step::Hover { seconds: 6.0 },
            Step::Roll {
                angle: 20.0_f64.to_radians(),
                seconds: 2.0,
            },
            Step::Hover { seconds: 4.0 },
            Step::Land,
            Step::Disarm,
        ],
        ..Scenario::default_mission()
    };
    (case.change)(&mut scenario);
    flight::fly(&scenario, &mut Silent)
}

fn row(case: &Case) -> String {
    let record = flown(case);
    let flying = record.samples.iter().filter(|s| -s.position[2] > AIRBORNE);
    let window: Vec<&Sample> = flying.take(WINDOW).collect();
    let of = |value: fn(&Sample) -> f64| swing(&window.iter().map(|s| value(s)).collect::<Vec<_>>());
    let [roll, pitch, yaw] = [of(|s| s.rate[0]), of(|s| s.rate[1]), of(|s| s.rate[2])];
    let mean =
        |value: fn(&Sample) -> f64| window.iter().map(|s| value(s)).sum::<f64>() / window.len().max(1) as f64;
    let throttle = mean(|s| s.throttle) * 100.0;
    let tilt = mean(|s| (s.tilt_measured[0] - s.tilt_model[0]).to_degrees());
    let shown = |s: Swing| format!("{:.0}°/s, {:.1} Hz", s.size.to_degrees(), s.hz);
    let end = if record.outcome.accomplished {
        "lands"
    } else {
        "does not"
    };
    format!(
        "| {} | {} | {} | {} | {:.0}°/s | {throttle:.0} % | {tilt:+.1}° | {end} |",
        case.what,
        case.seen,
        shown(roll),
        shown(pitch),
        yaw.size.to_degrees(),
    )
}

#[test]
fn the_symptoms_of_the_page_are_those_that_are_flown() {
    let mut table = String::from(
        "| what is wrong | the pilot sees | roll rate | pitch rate | yaw rate | throttle | tilt, measured − modelled | ends |\n\
         |---|---|---|---|---|---:|---:|---|\n",
    );
    for case in &CASES {
        let _ = writeln!(table, "{}", row(case));
    }
    sophie_pages::hold("tuning", &[("symptoms", table)], "--test sophie tuning::");
}
