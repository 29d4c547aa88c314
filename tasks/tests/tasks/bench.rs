//! The bench on the table: commands typed at the console, over the commander, down to the commands of motors and servos.

use std::cell::Cell;
use std::rc::Rc;

use embassy_time::Instant;
use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::{Configuration, PerArm};
use sophie_control::params::{Params, ServoMarks};
use sophie_control::pilot::actuator_test::{ActuatorTest, ActuatorTestRequest, PLACE_TIME, Spin};
use sophie_control::pilot::rc::Sticks;
use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_fakes::{Answer, FakeAnalog, FakeArms, FakeImu, FakeLine, FakeMotors, FakeServos};
use sophie_ports::receiver::RcState;
use sophie_ports::sensors::AnalogFrame;
use sophie_tasks::console;
use sophie_tasks::flight::{control, estimator, imu, mixer, motors};
use sophie_tasks::perching::{analog, arms, clamp, servos};
use sophie_tasks::pilot::commander;

use crate::console::{Board, Screen};
use crate::rig::Rig;

/// A battery of 15.2 V, pressure sensors without load.
pub const UNLOADED: AnalogFrame = AnalogFrame {
    fsr: [0; 4],
    battery_voltage: 1520,
    battery_current: 0,
    servo_battery: 0,
};

/// A vehicle on the table, all its tasks on scripted ports.
pub struct Table {
    pub rig: Rig,
    pub line: FakeLine,
    screen: Screen,
    pub imu: FakeImu,
    pub analog: FakeAnalog,
    pub arms: FakeArms,
    pub motors: FakeMotors,
    pub servos: FakeServos,
    /// What the receiver gives at 50 Hz; `None`: nothing.
    sticks: Rc<Cell<Option<Sticks>>>,
    /// Milliseconds for which each motor has turned, and its largest command.
    pub turned: PerArm<u32>,
    largest: PerArm<f32>,
}

impl Table {
    /// Disarmed, the arms open.
    pub fn set() -> Self {
        Self::starting(UNLOADED)
    }

    /// Disarmed, with what the converter has given since the power came on.
    fn starting(frame: AnalogFrame) -> Self {
        Self::with(frame, Params::DEFAULT)
    }

    /// The same with these parameters in force, and calibrated servos.
    pub fn with(frame: AnalogFrame, params: Params) -> Self {
        let servo_marks = ServoMarks::S1234;
        let mut table = Self::new(
            frame,
            Params {
                servo_marks,
                ..params
            },
        );
        assert_eq!(table.says("status", 100)[0], "DISARMED");
        table
    }

    /// A new board, whose servos have no marks.
    pub fn blank() -> Self {
        Self::new(UNLOADED, Params::DEFAULT)
    }

    fn new(frame: AnalogFrame, params: Params) -> Self {
        let mut table = Self {
            rig: Rig::with(params),
            line: FakeLine::default(),
            screen: Screen::default(),
            imu: FakeImu::default(),
            analog: FakeAnalog::default(),
            arms: FakeArms::default(),
            motors: FakeMotors::default(),
            servos: FakeServos::default(),
            sticks: Rc::default(),
            turned: [0; 4],
            largest: [0.0; 4],
        };
        table.analog.frame.set(frame);
        let (time, links) = (&table.rig.time, table.rig.links);
        time.spawn(imu::run(links, table.imu.clone()));
        time.spawn(estimator::run(links));
        time.spawn(control::run(links));
        time.spawn(mixer::run(links, |p| Flexible::new(Configuration::B, p)));
        time.spawn(motors::run(links, table.motors.clone()));
        time.spawn(analog::run(links, table.analog.clone()));
        time.spawn(arms::run(links, table.arms.clone()));
        time.spawn(clamp::run(links));
        time.spawn(servos::run(links, table.servos.clone()));
        time.spawn(commander::run(links));
        let (line, screen, board) = (table.line.clone(), table.screen.clone(), Board::default());
        time.spawn(console::run(links, line, screen, board.clone(), board));
        table.run(5000);
        table
    }

    /// A second console, at a line of its own.
    pub fn another(&self) -> (FakeLine, Screen) {
        let (line, screen, board) = (FakeLine::default(), Screen::default(), Board::default());
        let console = console::run(self.rig.links, line.clone(), screen.clone(), board.clone(), board);
        self.rig.time.spawn(console);
        (line, screen)
    }

    pub fn run(&mut self, ms: u32) {
        for i in 0..ms {
            let (sticks, at) = (self.sticks.get(), Instant::now());
            if let (Some(sticks), 0) = (sticks, i % 20) {
                let state = RcState {
                    sticks,
                    frames: 70,
                    errors: 0,
                };
                self.rig.links.rc.send(at, state);
            }
            self.rig.run(1);
            let now = self.motors.commands.get();
            for ((turned, largest), command) in self.turned.iter_mut().zip(&mut self.largest).zip(now) {
                *turned += u32::from(command != 0.0);
                *largest = largest.max(command);
            }
        }
    }

    /// What appears on the screen in `ms` milliseconds after `text` was typed, without the echo; motors are watched.
    pub fn says(&mut self, text: &str, ms: u32) -> Vec<String> {
        self.begins(text);
        self.run(ms);
        let said = self.screen.0.take();
        let lines = said.split_terminator("\r\n").skip(1);
        lines.filter(|line| *line != "> ").map(String::from).collect()
    }

    pub fn begins(&mut self, text: &str) {
        self.screen.0.take();
        self.line.put(format!("{text}\r").as_bytes());
        (self.turned, self.largest) = ([0; 4], [0.0; 4]);
    }

    /// What is said in `ms` milliseconds more.
    pub fn goes_on(&mut self, ms: u32) -> Vec<String> {
        self.screen.0.take();
        self.run(ms);
        let said = self.screen.0.take();
        said.split_terminator("\r\n")
            .filter(|line| *line != "> ")
            .map(String::from)
            .collect()
    }
}

const OFF: &str = "propellers off: motors may be tried until the next arming or restart";

#[test]
fn one_motor_turns_low_for_two_seconds_and_the_others_stand() {
    let mut table = Table::set();
    let refused = "refused: say 'propellers off' first, once they are";
    assert_eq!(table.says("motor 2", 3000), [refused]);
    assert_eq!(table.turned, [0; 4]);
    assert_eq!(table.says("propellers off", 200), [OFF]);
    for (typed, rotor, percent, command) in [("motor 2", 1, 8, 0.08), ("motor 4 12", 3, 12, 0.12)] {
        let said = table.says(typed, 3000);
        let number = rotor + 1;
        assert_eq!(
            said,
            [
                format!("motor {number} at {percent} % for 2 s; any key stops it"),
                format!("motor {number} stopped")
            ]
        );
        for (other, (turned, largest)) in table.turned.into_iter().zip(table.largest).enumerate() {
            if other == rotor {
                assert!((1980..=2020).contains(&turned), "{typed}: {turned} ms");
                assert!((largest - command).abs() < 1e-6, "{typed}: {largest}");
            } else {
                assert_eq!((turned, largest), (0, 0.0), "{typed}");
            }
        }
    }
    for (typed, answer) in [
        (
            "motor 5",
            "no motor '5'; 1 front-left, 2 rear-left, 3 front-right, 4 rear-right",
        ),
        ("motor 1 13", "a motor cannot be tried at '13'; 2 to 12 %"),
        ("motor 1 fast", "a motor cannot be tried at 'fast'; 2 to 12 %"),
        ("motor", "say 'motor N [%]'"),
    ] {
        assert_eq!(table.says(typed, 500), [answer]);
        assert_eq!(table.turned, [0; 4], "{typed}");
    }
}

#[test]
fn a_key_the_arm_switch_and_a_terminal_that_hangs_stop_a_motor() {
    let mut table = Table::set();
    table.says("propellers off", 200);
    table.begins("motor 1");
    table.run(600);
    table.line.put(b"x");
    assert_eq!(table.goes_on(400), ["motor 1 stopped by a key"]);
    // Half a second, and 60 ms until the key is seen.
    assert!((500..=680).contains(&table.turned[0]), "{} ms", table.turned[0]);

    table.sticks.set(Some(Sticks::default()));
    table.begins("motor 1");
    table.run(600);
    table.sticks.set(Some(Sticks {
        arm_switch: true,
        ..Sticks::default()
    }));
    let said = table.goes_on(400);
    assert_eq!(said, ["motor 1 stopped: arm switch on: turn it off first"]);
    assert!((500..=640).contains(&table.turned[0]), "{} ms", table.turned[0]);
    let said = table.says("motor 1", 400);
    assert_eq!(said, ["refused: arm switch on: turn it off first"]);
    assert_eq!(table.turned, [0; 4]);
}

#[test]
fn a_console_or_a_sensor_that_dies_stops_a_motor() {
    let mut table = Table::set();
    table.says("propellers off", 200);
    // A console that orders and is heard of no more.
    let order = ActuatorTest::Spin(Spin::at(2, 0.08));
    table.begins("");
    let request = ActuatorTestRequest { number: 1000, order };
    table.rig.links.actuator_test.send(Instant::now(), request);
    table.run(2000);
    assert!((100..=170).contains(&table.turned[2]), "{:?}", table.turned);

    table.begins("motor 1");
    table.run(500);
    table.imu.0.answer.set(Answer::Hangs);
    let said = table.goes_on(1000);
    assert_eq!(
        said[0],
        "motor 1 stopped: inertial sensor silent: motors wait for it"
    );
    assert!((400..=520).contains(&table.turned[0]), "{:?}", table.turned);
}

const TIED: &str = "tied down, propellers on: 'thrust' runs them until the next arming or restart";

#[test]
fn rotors_run_at_their_drive_once_the_vehicle_is_tied_down() {
    let mut table = Table::set();
    let refused = "refused: say 'tied down' first, once it is";
    assert_eq!(table.says("thrust all 60", 3000), [refused]);
    table.says("propellers off", 200);
    assert_eq!(table.says("thrust all 60", 3000), [refused]);
    assert_eq!(table.turned, [0; 4]);
    assert_eq!(table.says("tied down", 200), [TIED]);
    let spin = "refused: say 'propellers off' first, once they are";
    assert_eq!(table.says("motor 1", 3000), [spin]);
    for (typed, name, rotors, seconds, most) in [
        ("thrust all 60", "all", [true; 4], 6.2, 0.6),
        ("thrust 3 100", "3", [false, false, true, false], 7.0, 1.0),
        ("thrust all 30 to 60", "all", [true; 4], 11.6, 0.6),
    ] {
        let said = table.says(typed, 13_000);
        assert_eq!(
            said,
            [
                format!("rotor {name}: {seconds:.0} s; any key stops it"),
                format!("rotor {name} stopped")
            ]
        );
        for ((turned, largest), runs) in table.turned.into_iter().zip(table.largest).zip(rotors) {
            if runs {
                let expected = (seconds * 1000.0) as u32;
                assert!(turned.abs_diff(expected) <= 40, "{typed}: {turned} ms");
                assert!((largest - most).abs() < 1e-6, "{typed}: {largest}");
            } else {
                assert_eq!((turned, largest), (0, 0.0), "{typed}");
            }
        }
    }
    let takes = "thrust takes 5 to 100 %, and steps of at most 50 %";
    for (typed, answer) in [
        ("thrust all 4", takes),
        ("thrust all 101", takes),
        ("thrust 1 full", takes),
        ("thrust all 20 to 80", takes),
        (
            "thrust 5 60",
            "no rotor '5'; 1 front-left, 2 rear-left, 3 front-right, 4 rear-right",
        ),
        ("thrust all", "say 'thrust N %'"),
        ("thrust all 30 to", "say 'thrust N %'"),
    ] {
        assert_eq!(table.says(typed, 500), [answer]);
        assert_eq!(table.turned, [0; 4], "{typed}");
    }
}

#[test]
fn a_key_the_arm_switch_a_sensor_a_battery_and_a_silent_console_stop_the_rotors() {
    let mut table = Table::set();
    table.says("tied down", 200);
    table.begins("thrust all 100");
    table.run(1600);
    table.line.put(b"\x03");
    assert_eq!(table.goes_on(400), ["rotor all stopped by a key"]);
    assert!((1500..=1680).contains(&table.turned[0]), "{} ms", table.turned[0]);

    table.sticks.set(Some(Sticks::default()));
    table.begins("thrust all 100");
    table.run(600);
    table.sticks.set(Some(Sticks {
        arm_switch: true,
        ..Sticks::default()
    }));
    let said = table.goes_on(400);
    assert_eq!(said, ["rotor all stopped: arm switch on: turn it off first"]);
    assert!((500..=640).contains(&table.turned[0]), "{} ms", table.turned[0]);
    table.sticks.set(Some(Sticks::default()));
    table.run(100);

    // An order that is not renewed.
    let test = StaticThrustTest::steady(Rotors::All, 0.5);
    let order = ActuatorTest::StaticThrust(test);
    table.begins("");
    let request = ActuatorTestRequest { number: 1000, order };
    table.rig.links.actuator_test.send(Instant::now(), request);
    table.run(2000);
    assert!((100..=170).contains(&table.turned[2]), "{:?}", table.turned);

    // 12 V at the plug, as the filter follows it.
    table.begins("thrust all 100");
    table.run(600);
    table.analog.frame.set(AnalogFrame {
        battery_voltage: 1200,
        ..UNLOADED
    });
    let said = table.goes_on(1000);
    assert_eq!(said, ["rotor all stopped: battery critical or not measured"]);
    table.analog.frame.set(UNLOADED);
    table.run(1000);

    table.begins("thrust all 100");
    table.run(600);
    table.imu.0.answer.set(Answer::Hangs);
    let said = table.goes_on(1000);
    assert_eq!(
        said[0],
        "rotor all stopped: inertial sensor silent: motors wait for it"
    );
    assert!((500..=620).contains(&table.turned[0]), "{:?}", table.turned);
}

/// 550 to 2450 µs are 270 degrees: the pulse at `angle` degrees, µs.
fn pulse(angle: f32) -> f32 {
    550.0 + 1900.0 * angle.to_radians() / 4.71
}

#[test]
fn one_servo_goes_slowly_to_a_pulse_or_an_angle_and_back_to_its_release_mark() {
    let mut table = Table::set();
    let near = |pulses: PerArm<f32>, expected: PerArm<f32>| {
        pulses.iter().zip(expected).all(|(p, e)| (p - e).abs() < 0.6)
    };
    assert!(near(table.servos.now(), [550.0; 4]), "{:?}", table.servos.now());
    for (typed, servo, goal, angle) in [
        ("servo 1 pulse 1500", 0, 1500.0, 135),
        ("servo 3 angle 90", 2, pulse(90.0), 90),
        ("servo 4 pulse 2500", 3, 2500.0, 277),
    ] {
        table.servos.pulses.borrow_mut().clear();
        let said = table.says(typed, 6000);
        let number = servo + 1;
        let begun = format!("servo {number} to {goal:.0} us, {angle} deg from release; any key ends it");
        assert_eq!(said, [begun]);
        let mut expected = [550.0; 4];
        expected[servo] = goal;
        assert!(
            near(table.servos.now(), expected),
            "{typed}: {:?}",
            table.servos.now()
        );
        table.line.put(b" ");
        let back = format!("servo {number} back to its release mark by a key");
        assert_eq!(table.goes_on(3000), [back]);
        assert!(
            near(table.servos.now(), [550.0; 4]),
            "{typed}: {:?}",
            table.servos.now()
        );
        // 1 rad/s there and 3 rad/s back, µs a frame of 20 ms.
        let pulses = table.servos.pulses.borrow();
        for pair in pulses.windows(2) {
            let step = pair[1][servo] - pair[0][servo];
            assert!((-24.3..=8.2).contains(&step), "{typed}: {step} us");
        }
        drop(pulses);
        assert_eq!(table.turned, [0; 4]);
    }
    // Left alone it ends by itself.
    let ms = (1000.0 * PLACE_TIME) as u32 + 3000;
    assert_eq!(
        table.says("servo 2 release", ms),
        [
            "servo 2 to 550 us, 0 deg from release; any key ends it",
            "servo 2 back to its release mark"
        ]
    );
    let takes = "a servo takes 'release', 'pulse' 500 to 2500 us, 'angle' 0 to 270 deg";
    for typed in [
        "servo 1 pulse 499",
        "servo 1 pulse NaN",
        "servo 1 angle 271",
        "servo 1 angle -1",
        "servo 1 pulse",
        "servo 1 full",
        "servo 1 release 5",
    ] {
        assert_eq!(table.says(typed, 300), [takes], "{typed}");
    }
}

#[test]
fn arms_that_may_hold_the_vehicle_are_left_alone() {
    // 1200 counts are 287 Pa on two arms when the power comes on.
    let frame = AnalogFrame {
        fsr: [1200, 0, 1200, 0],
        ..UNLOADED
    };
    let mut table = Table::starting(frame);
    assert_eq!(table.says("propellers off", 200), [OFF]);
    for typed in ["motor 1", "servo 1 release", "servo 4 pulse 1500"] {
        let said = table.says(typed, 500);
        assert_eq!(
            said,
            ["refused: arms closed: perch switch on and off opens them"],
            "{typed}"
        );
    }
    assert_eq!(table.turned, [0; 4]);
    assert!(
        table
            .servos
            .pulses
            .borrow()
            .iter()
            .all(|pulses| *pulses == [0.0; 4])
    );
}

#[test]
fn numbers_are_watched_until_a_key() {
    let mut table = Table::set();
    table.sticks.set(Some(Sticks {
        roll: -0.25,
        throttle: 0.5,
        perch_switch: true,
        ..Sticks::default()
    }));
    table.run(100);
    for (group, row) in [
        (
            "sticks",
            "   -0.25    0.00    0.00    0.50    0.00    1.00    0.00    0.00",
        ),
        (
            "imu",
            "    0.00    0.00    0.00    0.00    0.00    0.00    0.00    0.00   -9.81",
        ),
        (
            "arms",
            "     0.0     0.0     0.0     0.0     0.0     0.0     0.0     0.0",
        ),
        (
            "grip",
            "     0.0     0.0     0.0     0.0     0.0     0.0     0.0     0.0",
        ),
        ("power", "   15.20    0.00    0.00       -"),
        ("thrust", "   1.000   0.200"),
        (
            "counts",
            "       0       0       0       0    1520       0       0",
        ),
    ] {
        let said = table.says(&format!("watch {group}"), 1100);
        assert!((7..=8).contains(&said.len()), "{said:?}");
        for line in &said {
            assert!(line.len() <= 80, "{line}");
        }
        assert!(said[2..].iter().all(|line| line == row), "{group}: {said:?}");
        table.line.put(b"q");
        table.run(300);
        assert!(table.screen.0.take().ends_with("> "));
        assert!(table.goes_on(1000).is_empty(), "{group}");
    }
    // What is silent is not shown as it was.
    table.sticks.set(None);
    table.imu.0.answer.set(Answer::Hangs);
    table.run(600);
    for (group, columns) in [("sticks", 8), ("imu", 9)] {
        let said = table.says(&format!("watch {group}"), 500);
        assert_eq!(said[2], "       -".repeat(columns));
        table.line.put(b"q");
        table.run(300);
    }
    assert_eq!(table.says("watch", 100).len(), 12);
    assert_eq!(table.says("watch nothing", 100).len(), 12);
}

#[test]
fn the_self_test_names_each_part_and_what_is_wrong_with_it() {
    let mut table = Table::set();
    table.sticks.set(Some(Sticks::default()));
    table.run(100);
    let said = table.says("selftest", 2000);
    assert_eq!(
        said,
        [
            "pass  stored parameters  nothing reported",
            "pass  chip               nothing reported",
            "pass  inertial sensor    9.81 m/s2 (9.4 to 10.2), 0.0 deg/s (3 at most)",
            "pass  gyro               bias 0.00 deg/s",
            "pass  receiver           70 frames, 0 errors",
            "pass  battery            15.20 V (13.6 at least)",
            "pass  pressure sensor 1  0 Pa (80 at most with open arms)",
            "pass  pressure sensor 2  0 Pa (80 at most with open arms)",
            "pass  pressure sensor 3  0 Pa (80 at most with open arms)",
            "pass  pressure sensor 4  0 Pa (80 at most with open arms)",
            "pass  arm sensor 1       tilt 0.0 deg (60 at most)",
            "pass  arm sensor 2       tilt 0.0 deg (60 at most)",
            "pass  arm sensor 3       tilt 0.0 deg (60 at most)",
            "pass  arm sensor 4       tilt 0.0 deg (60 at most)",
            "pass  servo frames       50 a second (47 at least)",
            "pass  motor frames       1000 a second (950 at least)",
            "pass  deadlines          0 missed (10 at most)",
            "all 17 passed",
        ]
    );
    let fails = |table: &mut Table| -> Vec<String> {
        let said = table.says("selftest", 2000);
        said.into_iter()
            .filter_map(|line| line.strip_prefix("FAIL  ").map(String::from))
            .collect()
    };
    table.sticks.set(None);
    table.arms.1[2].answer.set(Answer::Fails);
    let mut frame = table.analog.frame.get();
    frame.fsr = [0, 4095, 2000, 5000];
    frame.battery_voltage = 1300;
    table.analog.frame.set(frame);
    table.run(5000);
    let failed = fails(&mut table);
    assert_eq!(
        failed,
        [
            "receiver           silent: 0 frames, 0 errors",
            "battery            13.00 V (13.6 at least)",
            "pressure sensor 2  shorted",
            "pressure sensor 3  661 Pa (80 at most with open arms)",
            "pressure sensor 4  converter out of range",
            "arm sensor 3       silent",
        ]
    );
    table.analog.part.answer.set(Answer::Fails);
    table.imu.0.answer.set(Answer::Hangs);
    table.run(500);
    let failed = fails(&mut table);
    assert!(failed.contains(&"inertial sensor    silent".into()), "{failed:?}");
    assert!(failed.contains(&"pressure sensor 1  silent".into()), "{failed:?}");
    assert!(
        failed.contains(&"motor frames       0 a second (950 at least)".into()),
        "{failed:?}"
    );
}

#[test]
fn no_actuator_test_runs_while_armed() {
    let mut table = Table::set();
    table.says("propellers off", 200);
    table.sticks.set(Some(Sticks::default()));
    table.run(200);
    table.sticks.set(Some(Sticks {
        arm_switch: true,
        yaw: 1.0,
        ..Sticks::default()
    }));
    table.run(1500);
    assert_eq!(table.says("status", 100)[0], "ARMED");
    for typed in ["motor 1", "servo 1 pulse 1500", "propellers off"] {
        assert_eq!(
            table.says(typed, 300),
            ["refused: only while DISARMED"],
            "{typed}"
        );
        let idle = table.motors.commands.get();
        assert!(idle.iter().all(|c| (c - idle[0]).abs() < 1e-6), "{idle:?}");
    }
    let said = table.says("selftest", 300);
    assert_eq!(said, ["not tested while ARMED: disarm first"]);
}
