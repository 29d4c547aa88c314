//! What the parameters know of the vehicle.

use std::fmt::Write;

use sophie_control::gripper::contact_pressure::SensorLine;
use sophie_control::params::{Params, ServoMarks};

use super::parse;
use crate::scenario::draw::CHANCES;
use crate::scenario::keys::{KEYS, Kind};
use crate::scenario::uncertain::{QUANTITIES, Quantity, Spread};
use crate::scenario::{Overrides, Scenario};

/// A vehicle whose body, arms, rotors and servos are all unlike the default one.
const OTHER: &str = "infill = 8\ngain_k = 6\narm_coefficients = [2.5, -0.2, -0.17, 0.016]\narm_level_share = 0.45\n\
                     arm_gain = [1.2, 1.3, 1.1, 1.2]\narm_offset_deg = [2, -1, 1, -2]\nservo = 'mg996r'\n\
                     servo_release_us = [560, 600, 2450, 550]\nservo_full_us = [2400, 2440, 560, 2450]\nmass_kg = 2\n\
                     rotor_thrust = [0.96, 1.04, 1.02, 0.98]\nthrust_voltage_power = 1.7\n\
                     inertia_kgm2 = [0.03, 0.05, 0.07]\ntorque_ratio_m = 0.018\nmotor_tau_s = 0.08\nthrust_max_n = 9.5\n\
                     [sensors]\nposition = 'flow'\nflow_x_m = 0.1\n[world]\npipe_friction = 0.4\npipe_diameter_m = 0.25\n\
                     [faults]\npressure_gain = [1.2, 0.8, 0.85, 1.15]";

fn other(known: &str, seed: u64) -> Scenario {
    parse(&format!("seed = {seed}\n[vehicle]\nknown = '{known}'\n{OTHER}")).unwrap()
}

fn keys(scenario: &Scenario) -> Vec<String> {
    scenario.differences().into_iter().map(|d| d.key).collect()
}

#[test]
fn a_vehicle_that_is_known_exactly_differs_by_its_arms_sensors_and_pipe_alone() {
    assert!(keys(&Scenario::default_mission()).is_empty());
    let keys = keys(&other("exact", 1));
    assert_eq!(keys.len(), 4 + 4 + 4 + 2, "{keys:?}");
    assert!(keys.iter().all(|key| key.starts_with("vehicle.arm_gain[")
        || key.starts_with("vehicle.arm_offset_deg[")
        || key.starts_with("faults.")
        || key.starts_with("world.pipe_")));
}

#[test]
fn of_a_vehicle_as_built_the_labels_are_known_alone() {
    let known = other("as-built", 1).params;
    let marks = [known.servo_release_1, known.servo_full_3];
    assert!(
        (marks[0] - 560.0).abs() <= 4.0 && (marks[1] - 560.0).abs() <= 4.0,
        "{marks:?}"
    );
    let labels = Params {
        infill: 8.0,
        servo_stall: 0.922,
        servo_range: std::f32::consts::PI,
        servo_marks: ServoMarks::S1234,
        // Arming demands them: measured, not exact.
        servo_release_1: known.servo_release_1,
        servo_release_2: known.servo_release_2,
        servo_release_3: known.servo_release_3,
        servo_release_4: known.servo_release_4,
        servo_full_1: known.servo_full_1,
        servo_full_2: known.servo_full_2,
        servo_full_3: known.servo_full_3,
        servo_full_4: known.servo_full_4,
        ..Params::DEFAULT
    };
    assert_eq!(known, labels);
}

#[test]
fn a_calibration_finds_what_it_measures_within_its_error() {
    for seed in 0..200 {
        let s = other("calibrated", seed);
        let p = &s.params;
        for (found, truth, share) in [
            (p.mass, 2.0, 0.01),
            (p.thrust_max, 9.5, 0.02),
            // Each with its own error, and their mean is 1.
            (p.thrust_trim_1, 0.96, 0.03),
            (p.thrust_trim_2, 1.04, 0.03),
            (p.thrust_volt_exp, 1.7, 0.065),
            (p.motor_tau, 0.08, 0.15),
            (p.fsr_trim_1, 1.2, 0.12),
            (p.fsr_trim_4, 1.15, 0.12),
            (p.pipe_friction, 0.4, 0.065),
        ] {
            let off = (found / truth - 1.0).abs();
            assert!(off <= share + 1e-5 && off > 0.0, "{seed}: {found} for {truth}");
        }
        assert!((p.flow_x - 0.1).abs() <= 0.005_001);
        // Nothing measures them.
        let fixed = [p.inertia_roll, p.torque_ratio, p.gain_k];
        assert_eq!(fixed, [0.021, 0.016, 7.75]);
        // One equation for four arms of 1.1 to 1.3 times the softness: 1.2, 5 % off at most.
        let gain = s
            .differences()
            .into_iter()
            .find(|d| d.key == "vehicle.arm_gain[2]")
            .unwrap();
        assert!((gain.assumed / 1.2 - 1.0).abs() < 0.0501, "{gain:?}");
    }
}

/// Whatever the sensors are, the line in force reads the grip pressure 0.5 to 4.6 % low.
#[test]
fn a_calibrated_pressure_sensor_reads_the_grip_pressure_by_its_line() {
    let file = "[vehicle]\nknown = 'calibrated'\n[faults]\npressure_gain = [1.2, 0.8, 0.85, 1.15]\n[sensors]\n\
                fsr_turn_on_n = [0.1, 0.8, 0.3, 0.5]\nfsr_preload_n = [0.3, 0, 0.2, 0.1]\nfsr_hysteresis_percent = 8";
    for seed in 0..100 {
        let s = parse(&format!("seed = {seed}\n{file}")).unwrap();
        let lines = [0, 1, 2, 3].map(|arm| SensorLine::from_params(&s.params, arm));
        for (arm, line) in lines.into_iter().enumerate() {
            let (p, bend) = (&s.sensors.pressure, 2.0 * 0.178 / 0.3);
            let force = 950.0 * 0.001_444 + p.preload[arm] * bend - p.turn_on[arm];
            let conducts = s.faults.pressure_gain[arm] * force / 0.001_444;
            let reads = line.pressure(conducts as f32 / line.trim) / 950.0;
            assert!((0.95..0.998).contains(&reads), "{seed} {arm}: {reads} {line:?}");
        }
        // What is left of turn-on force and preload.
        let left = s.differences();
        let of = |key: &str| left.iter().find(|d| d.key == key).unwrap();
        let turn_on = of("sensors.fsr_turn_on_n[2]");
        assert!((turn_on.assumed - 0.8).abs() < 0.16, "{turn_on:?}");
    }
}

#[test]
fn rotors_that_are_known_have_trims_of_mean_one_and_what_is_common_is_in_the_largest_thrust() {
    let s = parse("[vehicle]\nrotor_thrust = [0.99, 1.07, 1.05, 1.01]\nthrust_voltage_power = 1.6").unwrap();
    let p = &s.params;
    let trims = [p.thrust_trim_1, p.thrust_trim_2, p.thrust_trim_3, p.thrust_trim_4];
    assert!((trims.iter().sum::<f32>() - 4.0).abs() < 1e-5, "{trims:?}");
    for (trim, factor) in trims.into_iter().zip([0.99, 1.07, 1.05, 1.01]) {
        assert!(
            (trim * p.thrust_max - 8.3 * factor).abs() < 1e-4,
            "{trim} {factor}"
        );
    }
    assert_eq!(p.thrust_volt_exp, 1.6);
    assert!(keys(&s).is_empty(), "{:?}", keys(&s));
    // Alike rotors and a winding's drop leave the defaults.
    let p = parse("").unwrap().params;
    assert_eq!(
        [p.thrust_max, p.thrust_trim_1, p.thrust_trim_4, p.thrust_volt_exp],
        [8.3, 1.0, 1.0, 2.0]
    );
}

#[test]
fn errors_belong_to_the_seed_and_each_part_has_its_own() {
    let trims = |seed| {
        let p = other("calibrated", seed).params;
        [p.fsr_trim_1 / 1.2, p.fsr_trim_2 / 0.8, p.thrust_max]
    };
    assert_eq!(trims(5), trims(5));
    assert_ne!(trims(5), trims(6));
    let [one, two, _] = trims(5);
    assert!((one - two).abs() > 1e-3);
}

#[test]
fn params_of_the_file_and_the_command_line_win() {
    let s = parse("[vehicle]\nknown = 'calibrated'\nthrust_max_n = 9.5\n[params]\nthrust_max = 9").unwrap();
    assert_eq!(s.params.thrust_max, 9.0);
    let overrides = Overrides {
        known: Some(crate::scenario::Known::AsBuilt),
        ..Overrides::default()
    };
    let s = Scenario::parse("[vehicle]\nthrust_max_n = 9.5", "f", &overrides).unwrap();
    assert_eq!(s.params.thrust_max, 8.3);
    assert_eq!(s.differences()[0].key, "vehicle.thrust_max_n");
    // The others are the lag, which is taken for that of slow motors, and marks of servos, which arming demands.
    assert!(
        keys(&s)
            .iter()
            .skip(1)
            .all(|key| key.starts_with("vehicle.motor_tau") || key.starts_with("vehicle.servo_"))
    );
    assert!((s.differences()[0].percent().unwrap() + 12.63).abs() < 0.01);
}

#[test]
fn every_number_of_a_spread_is_one_that_a_scenario_takes() {
    let nominal = Scenario::default_mission();
    for quantity in QUANTITIES {
        let ranges = ranges(quantity);
        for (index, number) in (quantity.truth)(&nominal).into_iter().enumerate() {
            let (min, max) = ranges.get(index).copied().unwrap_or_else(|| ranges[0]);
            for share in [0.0, 1.0] {
                let spread = |spread: Option<Spread>, from| spread.map_or(from, |s| s.apply(from, share));
                let sampled = spread(quantity.each, spread(quantity.all, number));
                assert!((min..=max).contains(&sampled), "{}: {sampled}", quantity.key);
            }
        }
    }
}

#[test]
fn a_servo_without_travel_is_refused() {
    for (keys, name) in [
        ("servo_full_us = [2450, 700, 2450, 2450]", "servo_full_us"),
        ("servo_release_us = [550, 550, 550, 2450]", "servo_release_us"),
    ] {
        let line = parse(&format!("[vehicle]\n{keys}")).unwrap_err().to_string();
        let begin = format!("perch.toml:2: vehicle.{name} = ");
        assert!(
            line.starts_with(&begin) && line.ends_with("200 us apart or more"),
            "{line}"
        );
    }
}

/// Ranges of a quantity's key, in the key's unit.
fn ranges(quantity: &Quantity) -> Vec<(f64, f64)> {
    let key = KEYS
        .iter()
        .find(|key| key.name == quantity.key)
        .expect(quantity.key);
    match &key.kind {
        Kind::Number(r, _) | Kind::Optional(r, _) | Kind::PerArm(r, _) => vec![(r.min, r.max)],
        Kind::PerAxis(ranges, _) => ranges.iter().map(|r| (r.min, r.max)).collect(),
        _ => panic!("{}: no number", quantity.key),
    }
}

#[test]
fn the_page_has_the_table() {
    let nominal = Scenario::default_mission();
    let mut text = String::from(
        "| scenario key | nominal | over builders and days | after calibration | by | source |\n|---|---|---|---|---|---|\n",
    );
    for quantity in QUANTITIES {
        let numbers: Vec<String> = (quantity.truth)(&nominal).iter().map(f64::to_string).collect();
        let mut spreads: Vec<String> = quantity.all.iter().map(|spread| spread.text()).collect();
        spreads.extend(quantity.each.map(|spread| format!("each {}", spread.text())));
        let (left, by) = quantity.calibration.map_or_else(Default::default, |c| {
            let each = if c.apart { "each " } else { "" };
            (format!("{each}{}", c.error.text()), c.by)
        });
        let (key, source) = (quantity.key, quantity.source);
        let (numbers, spreads) = (numbers.join(", "), spreads.join(", "));
        writeln!(
            text,
            "| `{key}` | {numbers} | {spreads} | {left} | {by} | {source} |"
        )
        .unwrap();
    }
    let mut chances = String::from("| scenario key | of a hundred | source |\n|---|---|---|\n");
    for chance in CHANCES {
        let (key, of_hundred, source) = (chance.key, 100.0 * chance.share, chance.source);
        writeln!(chances, "| `{key}` | {of_hundred:.0} | {source} |").unwrap();
    }
    sophie_pages::hold(
        "uncertainty",
        &[("quantities", text), ("chances", chances)],
        "--package sophie-sim --lib scenario",
    );
}
