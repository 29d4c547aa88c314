//! Calibration and the rotors' order, typed key by key: what is asked, what is found, what would change.

use embassy_time::Instant;
use sophie_control::calibration::Face;
use sophie_control::chain::ImuReading;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::flow_range_sample::{Flow, GroundView, Range};
use sophie_control::params::{MotorMap, MotorProtocol, Params};

use crate::bench::{Table, UNLOADED};

const ENTER: &str = "Enter when it is so, any other key ends:";

impl Table {
    /// Presses `keys` one by one, each answered within `ms` milliseconds; what is said to all of them.
    fn presses(&mut self, keys: &str, ms: u32) -> Vec<String> {
        keys.bytes()
            .flat_map(|key| {
                self.line.put(&[key]);
                self.goes_on(ms)
            })
            .map(|line| line.trim_end().to_string())
            .collect()
    }

    fn says_trimmed(&mut self, text: &str, ms: u32) -> Vec<String> {
        let said = self.says(text, ms);
        said.into_iter().map(|line| line.trim_end().to_string()).collect()
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

#[test]
fn a_level_rest_gives_the_bias_over_the_one_in_force() {
    let params = Params {
        accel_bias_x: 0.25,
        accel_bias_y: 0.0625,
        accel_bias_z: -0.125,
        ..Params::DEFAULT
    };
    let mut table = Table::with(UNLOADED, params);
    let asked = table.says_trimmed("calibrate level", 100);
    assert_eq!(
        asked,
        [
            "Put the vehicle on a level table, by a spirit level on its body.",
            ENTER
        ]
    );
    // The sensor reads gravity as it is.
    let said = table.presses("\r", 2500);
    let found: Vec<f32> = said[1..].iter().map(|line| value(line)).collect();
    assert!(
        found.len() == 3 && found.iter().all(|bias| bias.abs() < 1e-4),
        "{said:?}"
    );
    assert!(said[1].starts_with("accel_bias_x 0.25 -> ") && said[1].ends_with(" m/s2, in force after save"));
    assert!(said[3].starts_with("accel_bias_z -0.125 -> "));
    // A body that leans by 5°.
    table.lies(Face::Belly, Vec3::new(0.0, 0.85, 0.0));
    table.says("calibrate level", 100);
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
        ["not taken: bias along y is 0.85; -0.60 to 0.60 m/s2 allowed"]
    );
    let changes = table.says("changes", 100);
    assert_eq!(changes.len(), 4, "{changes:?}");
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
fn a_noisy_rest_is_refused_with_its_noise() {
    let mut table = Table::set();
    table.says("calibrate level", 100);
    table.line.put(b"\r");
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
fn six_sides_give_the_bias_and_a_wrong_side_is_asked_for_again() {
    let mut table = Table::set();
    let bias = Vec3::new(0.2, -0.1, 0.3);
    let mut said = table.says_trimmed("calibrate accel", 100);
    for (i, side) in Face::ALL.into_iter().enumerate() {
        assert_eq!(said[said.len() - 2..], [side.text(), ENTER]);
        if i == 2 {
            // Still on its back.
            let refused = table.presses("\r", 2500);
            let why = "not taken: gravity on this side is -0.20; 7.85 to 11.77 m/s2 allowed";
            assert_eq!(refused[1..], [why, side.text(), ENTER]);
        }
        table.lies(side, bias);
        said = table.presses("\r", 2500);
    }
    assert_eq!(said[1], "scale 1.000 1.000 1.000");
    for (line, (name, bias)) in said[2..].iter().zip([("x", 0.2), ("y", -0.1), ("z", 0.3)]) {
        assert!(line.starts_with(&format!("accel_bias_{name} 0 -> ")), "{line}");
        assert!((value(line) - bias).abs() < 1e-3, "{line}");
    }
    for (line, axis) in said[5..].iter().zip(["x", "y", "z"]) {
        assert!(line.starts_with(&format!("accel_scale_{axis} 1 -> ")), "{line}");
        assert!((value(line) - 1.0).abs() < 1e-3, "{line}");
    }
    assert_eq!(said.len(), 8);
}

/// A part that reads 12 % too much along y: more than a sound one, and more than can be taken out.
#[test]
fn a_scale_that_no_sound_part_has_is_refused_with_its_number() {
    let mut table = Table::set();
    table.says("calibrate accel", 100);
    let mut said = Vec::new();
    for side in Face::ALL {
        let y = side.force().y;
        table.lies(side, Vec3::new(0.0, 0.12 * y, 0.0));
        said = table.presses("\r", 2500);
    }
    assert_eq!(said[1..], ["not taken: scale of y is 1.12; 0.90 to 1.10 allowed"]);
    assert_eq!(table.says("changes", 100), ["no changes"]);
    assert_eq!(
        table.says("set accel_scale_y 1.12", 100),
        ["accel_scale_y cannot be 1.12; it takes 0.9 to 1.1"]
    );
}

#[test]
fn the_battery_is_read_as_the_meter_reads_it() {
    let mut table = Table::set();
    table.says("calibrate battery 15.5", 100);
    let said = table.presses("\r", 2500);
    assert!(said[1].starts_with("battery_divider 11 -> "), "{said:?}");
    // 15.2 V by the board.
    assert!((value(&said[1]) - 11.0 * 15.5 / 15.2).abs() < 1e-3, "{said:?}");
    table.says("calibrate battery 2", 100);
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
        ["not taken: the meter's reading is 2.00; 3.00 to 60.00 V allowed"]
    );
    assert_eq!(
        table.says("calibrate battery full", 100),
        ["'full' is not a number of volts"]
    );
}

#[test]
fn the_gyro_is_shown_and_a_key_ends_any_of_it() {
    let mut table = Table::set();
    table.says("calibrate gyro", 100);
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
        ["at rest 0.00 0.00 0.00 deg/s, noise 0.00; nothing to store"]
    );
    let ended = "ended: nothing is changed";
    for command in ["gyro", "level", "accel", "battery 15"] {
        table.says(&format!("calibrate {command}"), 100);
        assert_eq!(table.presses("x", 100), ["x", ended], "{command}");
        // In the midst of the samples.
        table.says(&format!("calibrate {command}"), 100);
        table.presses("\r", 1000);
        assert_eq!(table.presses("x", 100), [ended], "{command}");
    }
    assert_eq!(table.says("changes", 100), ["no changes"]);
    assert_eq!(table.says("calibrate", 100).len(), 10);
    assert_eq!(table.says("calibrate all", 100).len(), 10);
}

#[test]
fn a_servo_without_marks_starts_in_the_middle_and_goes_on_from_where_it_stands() {
    let mut table = Table::blank();
    assert_eq!(table.says("status", 100)[0], "DISARMED: servo not calibrated");
    assert_eq!(table.servos.now(), [0.0; 4]);
    for (typed, to) in [("release", "release"), ("angle", "angle 0")] {
        let said = table.says(&format!("servo 3 {to}"), 300);
        assert_eq!(
            said,
            ["servo 3 has no marks yet: 'calibrate servo 3', or 'servo 3 pulse'"],
            "{typed}"
        );
    }
    for (servo, number) in [(2, 3), (0, 1)] {
        let said = table.says(&format!("calibrate servo {number}"), 300);
        assert_eq!(said[1..], ["1500 us"]);
        let mut alone = [0.0; 4];
        alone[servo] = 1500.0;
        assert_eq!(table.servos.now(), alone);
        let said = table.presses(&"-".repeat(92), 200);
        assert_eq!(said.last().unwrap(), "580 us");
        let said = table.presses("\r", 200);
        assert_eq!(said[1..], ["580 us"], "on from the release mark");
        let said = table.presses(&"+".repeat(185), 200);
        assert_eq!(said.last().unwrap(), "2430 us");
        let marks = if number == 3 { "0 -> 3" } else { "3 -> 13" };
        assert_eq!(
            table.presses("\r", 200),
            [
                format!("servo_release_{number} 550 -> 580 us, in force after save"),
                format!("servo_full_{number} 2450 -> 2430 us, in force after save"),
                format!("servo_marks {marks}, in force after save"),
            ]
        );
        table.run(1000);
        assert_eq!(table.servos.now(), [0.0; 4]);
    }
    // One that is turned off by hand, and one that is given up.
    assert_eq!(
        table.says("servo 2 pulse 1500", 300),
        ["servo 2 to 1500 us; any key ends it"]
    );
    table.line.put(b" ");
    assert_eq!(table.goes_on(500), ["servo 2 without pulse again by a key"]);
    assert_eq!(table.servos.now(), [0.0; 4]);
}

#[test]
fn a_servos_marks_are_found_by_keys() {
    let mut table = Table::set();
    let said = table.says("calibrate servo 2", 300);
    assert_eq!(
        said,
        [
            "release mark: + and - move the servo, Enter takes it, any other key ends",
            "550 us"
        ]
    );
    // Five to and two back, then the full mark three back.
    let said = table.presses("+++++--", 200);
    assert_eq!(
        said,
        [
            "560 us", "570 us", "580 us", "590 us", "600 us", "590 us", "580 us"
        ]
    );
    assert!(
        (table.servos.now()[1] - 580.0).abs() < 1.0,
        "{:?}",
        table.servos.now()
    );
    let said = table.presses("\r---\r", 200);
    assert_eq!(
        said,
        [
            "full mark: + and - move the servo, Enter takes it, any other key ends",
            "2450 us",
            "2440 us",
            "2430 us",
            "2420 us",
            "servo_release_2 550 -> 580 us, in force after save",
            "servo_full_2 2450 -> 2420 us, in force after save",
            "servo_marks 1234 -> 1234, as in force",
        ]
    );
    table.run(6000);
    assert!(
        (table.servos.now()[1] - 550.0).abs() < 1.0,
        "{:?}",
        table.servos.now()
    );
    // No further than the parameters take, and nothing by another key.
    table.says("calibrate servo 1", 300);
    assert_eq!(table.presses("-x", 200), ["550 us", "ended: nothing is changed"]);
    assert_eq!(table.says("changes", 100).len(), 3);
}

#[test]
fn each_rotor_is_asked_for_and_what_is_to_be_swapped_is_said() {
    let mut table = Table::set();
    let refused = table.says("rotors", 300);
    assert_eq!(refused[1], "refused: say 'propellers off' first, once they are");
    table.says("propellers off", 100);
    // As it should; 2 and 3 swapped, 3 the wrong way; the last once more, and then nothing.
    table.says("rotors", 2500);
    for keys in ["1a", "3a", "2c"] {
        table.presses(keys, 2500);
    }
    let again = table.presses("r", 2500);
    assert_eq!(again[1], "output 4 turns for 2 s");
    let said = table.presses("0", 300);
    assert_eq!(
        said[1..],
        [
            "output 1: rotor 1, front-left, as it should",
            "output 2: rotor 3, front-right",
            "output 2: rotor 3 must turn clockwise; swap two of its motor's three wires",
            "output 3: rotor 2, rear-left",
            "output 4: nothing turned; see 'calibrate esc'",
            "after the change, battery off meanwhile, say 'rotors' again",
        ]
    );
    table.says("rotors", 2500);
    for keys in ["1a", "2c", "3c", "4"] {
        table.presses(keys, 2500);
    }
    let said = table.presses("a", 300);
    assert_eq!(said.len(), 6);
    assert_eq!(said[5], "all rotors as they should");
    // One that is named twice, and an end in between.
    table.says("rotors", 2500);
    for keys in ["1a", "1a", "3c", "4"] {
        table.presses(keys, 2500);
    }
    let said = table.presses("a", 300);
    assert_eq!(said[1], "output 1: rotor 1 was named twice; say 'rotors' again");
    table.says("rotors", 2500);
    assert_eq!(
        table.presses("x", 300).last().unwrap(),
        "ended: nothing is changed"
    );
}

#[test]
fn the_order_of_the_motors_wires_is_found_and_kept() {
    let mut table = Table::set();
    table.says("propellers off", 100);
    // 2 and 3 swapped, one of them the wrong way.
    table.says("rotors", 2500);
    for keys in ["1a", "3a", "2c", "4"] {
        table.presses(keys, 2500);
    }
    let said = table.presses("a", 300);
    assert_eq!(
        said[1..],
        [
            "output 1: rotor 1, front-left, as it should",
            "output 2: rotor 3, front-right",
            "output 2: rotor 3 must turn clockwise; swap two of its motor's three wires",
            "output 3: rotor 2, rear-left",
            "output 4: rotor 4, rear-right, as it should",
            "motor_map 1234 -> 1324, in force after save",
            "after 'save', and any swap with the battery off, say 'rotors' again",
        ]
    );
    assert_eq!(table.says("changes", 100)[0], "motor_map 1234 -> 1324");
    // Looked at again before it was saved, and wired otherwise meanwhile.
    table.says("rotors", 2500);
    for keys in ["1a", "2c", "3c", "4"] {
        table.presses(keys, 2500);
    }
    let said = table.presses("a", 300);
    assert_eq!(said[5], "motor_map 1324 -> 1234, as in force");
    assert_eq!(said[6], "all rotors as they should");
    assert_eq!(table.says("changes", 100), ["no changes"]);
    for wrong in ["1233", "0", "12345", "4444", "1234.5"] {
        let said = table.says(&format!("set motor_map {wrong}"), 100);
        let line = format!("motor_map cannot be {wrong}; it takes one of 24, 1234 to 4321");
        assert_eq!(said, [line]);
    }
}

#[test]
fn an_output_is_tried_by_its_number_whatever_the_map() {
    let mut table = Table::with(
        UNLOADED,
        Params {
            motor_map: MotorMap::of([1, 2, 0, 3]).unwrap(),
            ..Params::DEFAULT
        },
    );
    table.says("propellers off", 100);
    table.says("rotors", 1000);
    for (output, keys) in [(0, "2c"), (1, "3c"), (2, "1a"), (3, "4")] {
        let commands = table.motors.commands.get();
        assert!(
            (0..4).all(|other| (commands[other] > 0.0) == (other == output)),
            "{output}: {commands:?}"
        );
        table.run(1500);
        table.presses(keys, 1000);
    }
    let said = table.presses("a", 300);
    assert_eq!(said[1], "output 1: rotor 2, rear-left, as it should");
    assert_eq!(said[5], "all rotors as they should");
    // A motor is named by its rotor.
    table.says("motor 1", 500);
    let commands = table.motors.commands.get();
    assert!(commands[2] > 0.0 && commands[0] == 0.0, "{commands:?}");
}

#[test]
fn the_controllers_protocol_is_judged_by_what_the_builder_sees() {
    let mut table = Table::set();
    table.says("propellers off", 100);
    assert_eq!(table.says("calibrate esc", 2500)[0], "motor 1 by dshot300");
    assert_eq!(table.presses("y", 2500)[1], "motor 2 by dshot300");
    let said = table.presses("n", 300);
    assert_eq!(
        said[1..],
        [
            "controller 2 does not take dshot300, or has no power",
            "another: 'set motor_protocol pwm', 'save', and again"
        ]
    );
    table.says("calibrate esc", 2500);
    table.presses("yyy", 2500);
    let said = table.presses("y", 300);
    assert_eq!(said[1], "all four controllers take dshot300; nothing to store");
}

fn dji() -> Params {
    Params {
        motor_protocol: MotorProtocol::Pwm,
        motor_pulse_min: 1120.0,
        motor_pulse_idle: 1130.0,
        motor_pulse_max: 1920.0,
        ..Params::DEFAULT
    }
}

#[test]
fn the_idle_pulse_is_what_turns_the_last_motor() {
    let mut table = Table::with(UNLOADED, dji());
    table.says("propellers off", 100);
    // Motors that turn from 1160, 1180, 1150 and 1175 us on.
    let said = table.says("calibrate esc idle", 1000);
    assert_eq!(said, ["motor 1 at 1150 us"]);
    let command = table.motors.commands.get()[0];
    assert!((command - 30.0 / 800.0).abs() < 1e-6, "{command}");
    table.run(1500);
    let mut said = Vec::new();
    for key in ["n", "y", "n", "n", "y", "y"] {
        said.extend(table.presses(key, 2500));
    }
    said.extend(table.presses("y", 300));
    let said: Vec<_> = said.iter().filter(|line| line.starts_with("motor")).collect();
    assert_eq!(
        said,
        [
            "motor 1 at 1160 us",
            "motor 2 at 1160 us",
            "motor 2 at 1170 us",
            "motor 2 at 1180 us",
            "motor 3 at 1180 us",
            "motor 4 at 1180 us",
            "motor_pulse_idle 1130 -> 1180 us, in force after save",
        ]
    );
    // Tried by hand it turns at what is in force at least.
    let said = table.says("motor 1 2", 2500);
    assert_eq!(said[0], "motor 1 at 2 % for 2 s; any key stops it");
}

#[test]
fn a_motor_that_never_turns_leaves_the_idle_pulse_as_it_is() {
    let mut table = Table::with(UNLOADED, dji());
    table.says("propellers off", 100);
    table.says("calibrate esc idle", 2500);
    for _ in 0..6 {
        table.presses("n", 2500);
    }
    let said = table.presses("n", 300);
    assert_eq!(
        said[1],
        "not taken: motor 1 does not turn: power? motor_pulse_min, motor_pulse_max?"
    );
    assert_eq!(table.says("changes", 100), ["no changes"]);
    // What is typed instead of an answer ends it, and so does a key while it turns.
    table.says("calibrate esc idle", 2500);
    assert_eq!(table.presses("x", 300)[1], "ended");
    table.says("calibrate esc idle", 1000);
    assert_eq!(table.presses("x", 300), ["motor 1 stopped by a key"]);
    assert_eq!(table.motors.commands.get(), [0.0; 4]);
}

#[test]
fn pulses_out_of_order_turn_nothing_and_frames_have_none() {
    let params = Params {
        motor_pulse_idle: 1070.0,
        ..dji()
    };
    let mut table = Table::with(UNLOADED, params);
    table.says("propellers off", 100);
    let refused = ["refused: motor pulses out of order"];
    for command in ["motor 1", "calibrate esc idle"] {
        assert_eq!(table.says(command, 300), refused, "{command}");
    }
    let said = table.says("calibrate esc", 300);
    assert_eq!(
        said,
        [
            "it teaches no ends: BLHeli, AM32, Afro by their makers' procedure, DJI never",
            refused[0]
        ]
    );
    let mut table = Table::set();
    assert_eq!(
        table.says("calibrate esc idle", 100),
        ["dshot300 has no idle pulse; nothing to store"]
    );
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

#[test]
fn a_pressure_sensor_is_fitted_by_a_known_weight() {
    let mut table = Table::set();
    let mut frame = UNLOADED;
    // 100 counts are 17.3 Pa, 2047 counts 692.5 Pa: 675.2 Pa for 1.3 N on 1444 mm2, 900.3 Pa.
    frame.fsr[2] = 100;
    table.analog.frame.set(frame);
    let asked = table.says_trimmed("calibrate fsr 3 1.3", 100);
    assert_eq!(asked, ["Nothing may touch the sensor.", ENTER]);
    let said = table.presses("\r", 2500);
    assert_eq!(said[1..], ["Put the weight on its pad, all of it.", ENTER]);
    frame.fsr[2] = 2047;
    table.analog.frame.set(frame);
    let said = table.presses("\r", 2500);
    assert!(
        said[1].starts_with("fsr_trim_3 1 -> 0.75") && said[2].starts_with("fsr_zero_3 0 -> 23."),
        "{said:?}"
    );
    // Without the weight.
    table.says("calibrate fsr 1 1.3", 100);
    table.presses("\r", 2500);
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
        ["not taken: conductance over fsr_gain is 0.00; 0.20 to 5.00 allowed"]
    );
    assert_eq!(
        table.says("calibrate fsr 5 1", 100),
        ["no pressure sensor '5'; 1 front-left, 2 rear-left, 3 front-right, 4 rear-right"]
    );
    assert_eq!(
        table.says("calibrate fsr 1 much", 100),
        ["'much' is not a number of newtons"]
    );
}

#[test]
fn an_arms_sensor_gets_its_zero_and_its_sign() {
    let mut table = Table::set();
    // A body that rolls by 0.1 rad to the right under arms that stay: the left arms' tips seem to go up.
    let asked = table.says_trimmed("calibrate arm 1", 100);
    assert_eq!(asked, ["Hold the arm straight, by a ruler along it.", ENTER]);
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
        ["Bend its tip up by a hand's breadth, and hold.", ENTER]
    );
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
        ["not taken: turn of the arm is 0.00; 0.10 to 1.50 rad allowed"]
    );
    table.says("calibrate arm 1", 100);
    table.presses("\r", 2500);
    // Mounted the other way round: bent up, it shows a tip that goes down by 0.3 rad.
    table.arms.2.set(-0.3);
    table.run(200);
    let said = table.presses("\r", 2500);
    assert_eq!(
        said[1..],
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
    for (lie, answers) in [
        (
            [Face::Belly, Face::Nose, Face::Right],
            &[
                "mounted as the firmware has it",
                "imu_mounting 0 forward_down -> 0 forward_down, as in force",
            ][..],
        ),
        (
            [Face::Belly, Face::Right, Face::Tail],
            &[
                "nose is where the firmware has right, right side back, belly down",
                "imu_mounting 0 forward_down -> 8 right_down, in force after save",
            ],
        ),
        (
            [Face::Belly, Face::Tail, Face::Right],
            &["not taken: these are no three sides of one vehicle"],
        ),
    ] {
        table.lies(lie[0], Vec3::ZERO);
        let asked = table.says_trimmed("calibrate mounting", 100);
        assert_eq!(asked, [Face::Belly.text(), ENTER]);
        table.presses("\r", 2500);
        table.lies(lie[1], Vec3::ZERO);
        let asked = table.presses("\r", 2500);
        assert_eq!(asked[1..], [Face::Right.text(), ENTER]);
        table.lies(lie[2], Vec3::ZERO);
        assert_eq!(table.presses("\r", 2500)[1..], *answers);
    }
}

/// Hands that turn the vehicle `distance` m over a floor, and a module that sits a quarter turn beyond its parameter
/// with 1.2 times its counts.
fn turned_over_a_floor(table: &mut Table, distance: f32, quality: u8) -> Vec<String> {
    let mut turn = Vec::new();
    table.line.put(b"\r");
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
    let asked = table.says_trimmed("calibrate flow", 100);
    assert!(asked[0].starts_with("Hold it 0.5 m over a floor"), "{asked:?}");
    let asked = turned_over_a_floor(&mut table, 0.5, 120);
    assert!(
        asked.iter().any(|line| line.starts_with("Now 1.5 m")),
        "{asked:?}"
    );
    let said = turned_over_a_floor(&mut table, 1.5, 120);
    let line = |begin: &str| {
        let found = said.iter().find(|line| line.starts_with(begin));
        found.unwrap_or_else(|| panic!("{said:?}")).clone()
    };
    let scale = value(&line("flow_scale 10.5 -> "));
    assert!((scale / 12.6 - 1.0).abs() < 0.02, "{scale}");
    assert!(line("flow_mounting").contains("-> 90 right"), "{said:?}");
    assert!(
        line("turned about a point").contains(" 0 cm over the lens"),
        "{said:?}"
    );
    // In the dark nothing is taken.
    table.says("defaults", 100);
    table.says("calibrate flow", 100);
    let said = turned_over_a_floor(&mut table, 0.5, 5);
    let why = "not taken: quality of the picture is 5.00; 20.00 to 255.00 allowed";
    assert!(said.iter().any(|line| line == why), "{said:?}");
    // Without a module.
    table.says("calibrate flow", 100);
    table.run(500);
    let said = table.presses("\r", 9000);
    assert!(
        said.iter()
            .any(|line| line.starts_with("not taken: flows is 0.00")),
        "{said:?}"
    );
}
