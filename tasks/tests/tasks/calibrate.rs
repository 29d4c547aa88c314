//! Calibrations and motors by hand, as verbs of the console: what is measured, what would change.

use embassy_time::Instant;
use sophie_control::calibration::Face;
use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::flow_range_sample::{Flow, GroundView, Range};
use sophie_control::params::{MotorProtocol, Params};

use crate::bench::{Table, UNLOADED};

const MEASURES: &str = "measures for 2.5 s; a key ends it";
const TAKEN: &str = "taken: now the next step";

impl Table {
    /// What a calibration's step says once it is measured.
    fn calibrates(&mut self, verb: &str) -> Vec<String> {
        let said = self.says(&format!("calibrate {verb}"), 2700);
        assert_eq!(said[0], MEASURES, "{said:?}");
        said[1..].to_vec()
    }

    /// Puts the vehicle on `side`, with what its sensor reads beyond gravity.
    fn lies(&mut self, side: Face, beyond: Vec3) {
        self.imu.2.set(ImuReading {
            gyro: Vec3::ZERO,
            accel: side.force() - Face::Belly.force() + beyond,
        });
        self.run(500);
    }
}

/// The number after the arrow.
fn value(line: &str) -> f32 {
    let (_, rest) = line.split_once(" -> ").unwrap_or_else(|| panic!("{line}"));
    rest.split_whitespace()
        .next()
        .unwrap()
        .trim_end_matches(',')
        .parse()
        .unwrap()
}

#[test]
fn a_level_rest_gives_the_bias_over_the_one_in_force() {
    let params = Params {
        accel_bias_x: 0.25,
        accel_bias_y: 0.0625,
        accel_bias_z: -0.125,
        ..Params::DEFAULT
    };
    let mut table = Table::with(UNLOADED, params);
    // The sensor reads gravity as it is.
    let said = table.calibrates("level");
    let found: Vec<f32> = said.iter().map(|line| value(line)).collect();
    assert!(
        found.len() == 3 && found.iter().all(|bias| bias.abs() < 1e-4),
        "{said:?}"
    );
    assert!(said[0].starts_with("accel_bias_x 0.25 -> ") && said[0].ends_with(" m/s2, in force after save"));
    assert!(said[2].starts_with("accel_bias_z -0.125 -> "));
    // A body that leans by 5°.
    table.lies(Face::Belly, Vec3::new(0.0, 0.85, 0.0));
    assert_eq!(
        table.calibrates("level"),
        ["not taken: bias along y is 0.85; -0.60 to 0.60 m/s2 allowed"]
    );
    let changes = table.says("changes", 100);
    assert_eq!(changes.len(), 4, "{changes:?}");
}

#[test]
fn a_noisy_rest_is_refused_with_its_noise() {
    let mut table = Table::set();
    table.says("calibrate level", 100);
    table.lies(Face::Belly, Vec3::new(2.0, 0.0, 0.0));
    table.imu.2.set(ImuReading::default());
    let said = table.goes_on(2500);
    assert!(
        said.len() == 1
            && said[0].starts_with("not taken: noise is 0.")
            && said[0].ends_with("0.00 to 0.15 m/s2 allowed"),
        "{said:?}"
    );
    assert_eq!(table.says("changes", 100), ["no changes"]);
}

#[test]
fn six_sides_give_the_bias_and_a_wrong_side_is_measured_again() {
    let mut table = Table::set();
    let bias = Vec3::new(0.2, -0.1, 0.3);
    let mut said = Vec::new();
    for (i, side) in Face::ALL.into_iter().enumerate() {
        let verb = format!("accel {}", side.name());
        if i == 2 {
            // Still on its back.
            let why = "not taken: gravity on this side is -0.20; 7.85 to 11.77 m/s2 allowed";
            assert_eq!(table.calibrates(&verb), [why]);
        }
        table.lies(side, bias);
        said = table.calibrates(&verb);
        assert_eq!(said == [TAKEN], i < 5, "{said:?}");
    }
    for (line, (name, bias)) in said.iter().zip([("x", 0.2), ("y", -0.1), ("z", 0.3)]) {
        assert!(line.starts_with(&format!("accel_bias_{name} 0 -> ")), "{line}");
        assert!((value(line) - bias).abs() < 1e-3, "{line}");
    }
    for (line, axis) in said[3..].iter().zip(["x", "y", "z"]) {
        assert!(line.starts_with(&format!("accel_scale_{axis} 1 -> ")), "{line}");
        assert!((value(line) - 1.0).abs() < 1e-3, "{line}");
    }
    assert_eq!(said.len(), 6);
    // A step alone is not measured.
    assert_eq!(
        table.says("calibrate accel left", 100),
        ["not measured: the step before it first, within ten minutes"]
    );
}

/// A part that reads 12 % too much along y: more than a sound one, and more than can be taken out.
#[test]
fn a_scale_that_no_sound_part_has_is_refused_with_its_number() {
    let mut table = Table::set();
    let mut said = Vec::new();
    for side in Face::ALL {
        let y = side.force().y;
        table.lies(side, Vec3::new(0.0, 0.12 * y, 0.0));
        said = table.calibrates(&format!("accel {}", side.name()));
    }
    assert_eq!(said, ["not taken: scale of y is 1.12; 0.90 to 1.10 allowed"]);
    assert_eq!(table.says("changes", 100), ["no changes"]);
    assert_eq!(
        table.says("set accel_scale_y 1.12", 100),
        ["accel_scale_y cannot be 1.12; it takes 0.9 to 1.1"]
    );
}

#[test]
fn the_battery_is_read_as_the_meter_reads_it() {
    let mut table = Table::set();
    let said = table.calibrates("battery 15.5");
    assert!(said[0].starts_with("battery_divider 11 -> "), "{said:?}");
    // 15.2 V by the board.
    assert!((value(&said[0]) - 11.0 * 15.5 / 15.2).abs() < 1e-3, "{said:?}");
    assert_eq!(
        table.calibrates("battery 2"),
        ["not taken: the meter's reading is 2.00; 3.00 to 60.00 V allowed"]
    );
}

#[test]
fn the_gyro_is_shown_and_a_key_ends_any_of_it() {
    let mut table = Table::set();
    assert_eq!(
        table.calibrates("gyro"),
        ["at rest 0.00 0.00 0.00 deg/s, noise 0.00; nothing to store"]
    );
    for verb in ["gyro", "level", "accel belly", "battery 15"] {
        table.says(&format!("calibrate {verb}"), 1000);
        table.line.put(b"x");
        assert_eq!(table.goes_on(100), ["ended: nothing is changed"], "{verb}");
    }
    assert_eq!(table.says("changes", 100), ["no changes"]);
    for other in [
        "",
        " all",
        " battery full",
        " fsr 5 1",
        " fsr 1 much",
        " arm 1",
        " servo 1",
    ] {
        let said = table.says(&format!("calibrate{other}"), 100);
        assert_eq!(said.len(), 11, "{other}: {said:?}");
        assert!(said.iter().all(|line| line.len() < 80), "{said:?}");
    }
}

#[test]
fn a_servo_without_marks_gets_them_by_pulses() {
    let mut table = Table::blank();
    assert_eq!(table.says("status", 100)[0], "DISARMED: servo not calibrated");
    assert_eq!(table.servos.now(), [0.0; 4]);
    for to in ["release", "angle 0"] {
        let said = table.says(&format!("servo 3 {to}"), 300);
        assert_eq!(
            said,
            ["servo 3 has no marks yet: find them by 'servo 3 pulse', then 'calibrate servo'"]
        );
    }
    assert_eq!(
        table.says("servo 3 pulse 1500", 300),
        ["servo 3 to 1500 us; any key ends it"]
    );
    assert_eq!(table.servos.now(), [0.0, 0.0, 1500.0, 0.0]);
    table.line.put(b" ");
    assert_eq!(table.goes_on(500), ["servo 3 without pulse again by a key"]);
    assert_eq!(table.servos.now(), [0.0; 4]);
    for (number, marks) in [(3, "0 -> 3"), (1, "3 -> 13")] {
        let said = table.says(&format!("calibrate servo {number} 580 2430"), 300);
        assert_eq!(
            said[1..],
            [
                format!("servo_release_{number} 550 -> 580 us, in force after save"),
                format!("servo_full_{number} 2450 -> 2430 us, in force after save"),
                format!("servo_marks {marks}, in force after save"),
            ]
        );
    }
    let said = table.says("calibrate servo 2 1500 1600", 300);
    assert_eq!(
        said[1..],
        ["not taken: travel is 100.00; 200.00 to 1900.00 us allowed"]
    );
    assert_eq!(table.says("changes", 100).len(), 6);
}

fn dji() -> Params {
    Params {
        motor_protocol: MotorProtocol::Pwm,
        motor_pulse_min: 1120.0,
        motor_pulse_idle: 1180.0,
        motor_pulse_max: 1920.0,
        ..Params::DEFAULT
    }
}

#[test]
fn the_pulse_that_turns_a_motor_is_found_by_hand() {
    let mut table = Table::with(UNLOADED, dji());
    table.says("propellers off", 100);
    // Below the pulse in force, which a test in percent is raised to.
    for (typed, drive) in [("1150 us", 30.0 / 800.0), ("2", 60.0 / 800.0)] {
        let said = table.says(&format!("motor 1 {typed}"), 1000);
        assert!(said[0].starts_with("motor 1 at "), "{said:?}");
        let command = table.motors.commands.get()[0];
        assert!((command - drive).abs() < 1e-5, "{typed}: {command}");
        table.line.put(b"x");
        assert_eq!(table.goes_on(300), ["motor 1 stopped by a key"]);
        assert_eq!(table.motors.commands.get(), [0.0; 4]);
    }
    for typed in ["1120", "1300", "much"] {
        assert_eq!(
            table.says(&format!("motor 1 {typed} us"), 100),
            [format!("a motor cannot be tried at '{typed}'; 1136 to 1216 us")]
        );
    }
}

#[test]
fn motor_pulses_out_of_order_turn_no_motor() {
    let params = Params {
        motor_pulse_idle: 1070.0,
        ..dji()
    };
    let mut table = Table::with(UNLOADED, params);
    table.says("propellers off", 100);
    for command in ["motor 1", "motor 1 1050 us"] {
        assert_eq!(
            table.says(command, 300),
            ["refused: motor pulses out of order"],
            "{command}"
        );
    }
}

#[test]
fn a_dead_zone_wider_than_the_bench_s_drive_is_jumped_over() {
    // PX4's F450 turns from 1230 us on.
    let params = Params {
        motor_pulse_idle: 1230.0,
        ..dji()
    };
    let mut table = Table::with(UNLOADED, params);
    table.says("propellers off", 100);
    let said = table.says("motor 3", 1000);
    assert_eq!(said, ["motor 3 at 14 % for 2 s; any key stops it"]);
    let command = table.motors.commands.get()[2];
    assert!((command - 110.0 / 800.0).abs() < 1e-5, "{command}");
}

/// Counts of a sensor of 10 kOhm that conducts as under `pascal` Pa on 1444 mm2.
fn counts(pascal: f32) -> u16 {
    let load = pascal * 0.001_444 * 1e-4 * 1e4;
    (4095.0 * load / (1.0 + load)).round() as u16
}

#[test]
fn a_pressure_sensor_is_fitted_by_known_loads_up_and_down() {
    let mut table = Table::set();
    let mut said = Vec::new();
    // It begins at 200 Pa, has 0.8 of the conductance and 5 % of hysteresis.
    let loads = [
        ("0.94", 0.95),
        ("1.37", 0.95),
        ("1.95", 0.95),
        ("1.37", 1.05),
        ("0.94", 1.05),
    ];
    assert_eq!(table.calibrates("fsr 3 empty"), [TAKEN]);
    for (newton, side) in loads {
        let pascal: f32 = newton.parse::<f32>().unwrap() / 0.001_444;
        let mut frame = UNLOADED;
        frame.fsr[2] = counts(0.8 * (side * pascal - 200.0));
        table.analog.frame.set(frame);
        table.run(500);
        said = table.calibrates(&format!("fsr 3 {newton}"));
        assert_eq!(said, [TAKEN], "{newton}");
    }
    table.analog.frame.set(UNLOADED);
    table.run(500);
    said.clone_from(&table.calibrates("fsr 3 empty"));
    assert!(
        said[0].starts_with("fsr_trim_3 1 -> ") && said[1].starts_with("fsr_zero_3 0 -> -"),
        "{said:?}"
    );
    assert!((value(&said[0]) - 0.8).abs() < 0.004, "{said:?}");
    assert!((value(&said[1]) + 200.0).abs() < 4.0, "{said:?}");
    assert!(
        said[2].starts_with("within 4")
            && said[2].ends_with(" Pa at 950 Pa; hysteresis 5.0 %; 0 Pa at the end, empty"),
        "{said:?}"
    );
    // A load without the empty pad before, and one that is not put on.
    assert_eq!(
        table.says("calibrate fsr 1 0.94", 100),
        ["not measured: the step before it first, within ten minutes"]
    );
    table.calibrates("fsr 1 empty");
    let said = table.calibrates("fsr 1 0.94");
    assert!(
        said[0].starts_with("not taken: reading of the load is 0.00; 32."),
        "{said:?}"
    );
}

#[test]
fn an_arms_sensor_gets_its_zero_and_its_sign() {
    let mut table = Table::set();
    assert_eq!(table.calibrates("arm 1 straight"), [TAKEN]);
    assert_eq!(
        table.calibrates("arm 1 up"),
        ["not taken: turn of the arm is 0.00; 0.10 to 1.50 rad allowed"]
    );
    // Mounted the other way round: bent up, it shows a tip that goes down by 0.3 rad.
    table.arms.2.set(-0.3);
    table.run(200);
    assert_eq!(
        table.calibrates("arm 1 up"),
        [
            "arm_sign_1 1 along -> -1 reversed, in force after save",
            "arm_zero_1 0 -> 0 rad, as in force"
        ]
    );
}

#[test]
fn the_mounting_is_found_by_tilting() {
    let mut table = Table::set();
    // As it lies, and what the sensor takes for it.
    for (lie, answer) in [
        (
            [Face::Belly, Face::Nose, Face::Right],
            "imu_mounting 0 forward_down -> 0 forward_down, as in force",
        ),
        (
            [Face::Belly, Face::Right, Face::Tail],
            "imu_mounting 0 forward_down -> 8 right_down, in force after save",
        ),
        (
            [Face::Belly, Face::Tail, Face::Right],
            "not taken: three sides of one vehicle is 0.00; 1.00 to 1.00 allowed",
        ),
    ] {
        for (face, asked) in lie.into_iter().zip(["belly", "nose", "right"]) {
            table.lies(face, Vec3::ZERO);
            let said = table.calibrates(&format!("mounting {asked}"));
            let expected = if asked == "right" { answer } else { TAKEN };
            assert_eq!(said, [expected], "{lie:?}");
        }
    }
}

/// Hands that turn the vehicle `distance` m over a floor, and a module that sits a quarter turn beyond its parameter
/// with 1.2 times its counts.
fn turned_over_a_floor(table: &mut Table, distance: f32, quality: u8) -> Vec<String> {
    let mut turn = Vec::new();
    let mut said = Vec::new();
    for ms in 0..8600u32 {
        let t = ms as f32 * 1e-3;
        let rate = |w: f32| 0.35 * w * (w * t).cos();
        let gyro = Vec3::new(rate(3.5), rate(4.3), 0.0);
        // What the accelerometer would read in hands, so that the attitude follows the gyro.
        let q = Quat::from_euler(0.35 * (3.5 * t).sin(), 0.35 * (4.3 * t).sin(), 0.0);
        table.imu.2.set(ImuReading {
            gyro,
            accel: q.rotate_inverse(Face::Belly.force()) - Face::Belly.force(),
        });
        turn.push(gyro);
        if ms % 20 == 0 && ms >= 45 {
            let until = ms as usize - 25;
            let seen = turn[until - 20..until]
                .iter()
                .fold(Vec3::ZERO, |sum, rate| sum + *rate * 1e-3);
            let noise = (ms / 20 % 5) as f32 * 1e-4;
            let now = Instant::now();
            let measured = now.as_micros() - 25_000;
            let view = GroundView {
                flow: Some(Flow {
                    until_us: measured,
                    seconds: 0.02,
                    angle: [1.2 * seen.y + noise, -1.2 * seen.x],
                    quality,
                }),
                range: Some(Range {
                    at_us: measured,
                    distance: Some(distance + noise),
                    reach: (0.02, 8.0),
                }),
            };
            table.rig.links.ground.send(now, view);
        }
        said.extend(table.goes_on(1));
    }
    table.imu.2.set(ImuReading::default());
    said
}

#[test]
fn the_flow_modules_scale_and_mounting_are_found_by_turning_it() {
    let mut table = Table::set();
    let said = table.says("calibrate flow near", 100);
    assert_eq!(said, ["measures for 8 s; a key ends it"]);
    assert_eq!(turned_over_a_floor(&mut table, 0.5, 120), [TAKEN]);
    table.says("calibrate flow far", 100);
    let said = turned_over_a_floor(&mut table, 1.5, 120);
    let line = |begin: &str| {
        let found = said.iter().find(|line| line.starts_with(begin));
        found.unwrap_or_else(|| panic!("{said:?}")).clone()
    };
    let scale = value(&line("flow_scale 10.5 -> "));
    assert!((scale / 12.6 - 1.0).abs() < 0.02, "{scale}");
    assert!(line("flow_mounting").contains("-> 90 right"), "{said:?}");
    // In the dark nothing is taken.
    table.says("calibrate flow near", 100);
    let said = turned_over_a_floor(&mut table, 0.5, 5);
    assert_eq!(
        said,
        ["not taken: quality of the picture is 5.00; 20.00 to 255.00 allowed"]
    );
    // Without a module.
    table.says("calibrate flow near", 100);
    let said = table.goes_on(9000);
    assert!(said[0].starts_with("not taken: flows is 0.00"), "{said:?}");
}
