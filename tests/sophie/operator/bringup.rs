//! `sophie bringup`: a vehicle from its factory state to `all steps passed`, with interruptions, by a builder whose
//! replies come through a pipe and whose hands move the board's parts.

use std::fs;
use std::io::{Read, Write};
use std::process::{Child, ChildStdin, Stdio};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use sophie_bringup::STEPS;
use sophie_control::calibration::Face;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;
use sophie_control::pilot::rc::{ArmChoice, StickMode, Sticks};
use sophie_sim::live::Key;
use sophie_sim::scenario::Scenario;
use sophie_sim::sensors::fsr::FsrErrors;
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::sled::drawn;
use sophie_sim::test_stands::twist_stand::TwistStand;

use super::board::{Board, Hands, Pads};
use super::run;
use sophie_tasks::supervision::self_test::ROWS;
use sophie_test_support::command::{Temp, command, refused};

/// What the accelerometer reads beyond gravity.
const BIAS: Vec3 = Vec3::new(0.11, -0.04, 0.08);
/// A key of MAVLink.
pub(super) const KEY: &str = "00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff";
/// Longest wait for a prompt, whatever the load of the machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// A builder at `sophie bringup`.
pub(super) struct Builder {
    child: Child,
    typed: ChildStdin,
    said: Arc<Mutex<String>>,
    /// Bytes of what was said that have been read.
    read: usize,
}

impl Builder {
    /// With `more` arguments.
    pub(super) fn begins(temp: &Temp, board: &Board, more: &[&str]) -> Self {
        Self::patient(temp, board, "5", more)
    }

    /// With a patience of `seconds` and `more` arguments.
    fn patient(temp: &Temp, board: &Board, seconds: &str, more: &[&str]) -> Self {
        let name = board.name();
        let args = [&["bringup", "--port", &name, "--patience", seconds], more].concat();
        let mut child = command(&temp.0, &args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let said = Arc::new(Mutex::new(String::new()));
        let (mut out, shared) = (child.stdout.take().unwrap(), said.clone());
        std::thread::spawn(move || {
            let mut bytes = [0; 1024];
            while let Ok(count @ 1..) = out.read(&mut bytes) {
                shared
                    .lock()
                    .unwrap()
                    .push_str(&String::from_utf8_lossy(&bytes[..count]));
            }
        });
        let typed = child.stdin.take().unwrap();
        Self {
            child,
            typed,
            said,
            read: 0,
        }
    }

    /// Ctrl-C.
    pub(super) fn interrupts(&self) {
        super::interrupt(&self.child);
    }

    /// Waits until `text` is said, after what was waited for before.
    pub(super) fn hears(&mut self, text: &str) {
        let begun = Instant::now();
        loop {
            let said = self.said.lock().unwrap().clone();
            if let Some(at) = said[self.read..].find(text) {
                self.read += at + text.len();
                return;
            }
            assert!(
                begun.elapsed() < PATIENCE && self.child.try_wait().unwrap().is_none(),
                "'{text}' does not come:\n{}",
                &said[self.read..]
            );
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// His computer goes away.
    pub(super) fn loses_the_computer(mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }

    pub(super) fn types(&mut self, reply: &str) {
        self.typed.write_all(format!("{reply}\n").as_bytes()).unwrap();
    }

    /// Waits for `prompt` and replies.
    pub(super) fn at(&mut self, prompt: &str, reply: &str) {
        self.hears(prompt);
        self.types(reply);
    }

    /// Begins the step `id`, which comes next.
    pub(super) fn step(&mut self, id: &str) {
        self.at(&format!("({id})"), "");
    }

    /// A rest that is asked for, after what hands do.
    fn rests(&mut self, text: &str, hands: impl FnOnce()) {
        self.hears(text);
        hands();
        self.at("Enter when it is so", "");
    }

    /// Exit status, and what was said last on stdout and stderr.
    pub(super) fn ends(mut self) -> (Option<i32>, String, String) {
        drop(self.typed);
        let status = self.child.wait().unwrap();
        let mut complaint = String::new();
        self.child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut complaint)
            .unwrap();
        let begun = Instant::now();
        loop {
            let said = self.said.lock().unwrap().clone();
            if said.contains("\nProtocol: ") || !complaint.is_empty() || begun.elapsed() > PATIENCE {
                return (status.code(), said, complaint);
            }
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

fn lies(board: &Board, side: Face) {
    board.hands(|hands| hands.force = side.force() + BIAS);
    // The samples of a rest are filtered.
    board.pass(1.0);
}

/// A vehicle out of its bag.
pub(super) fn factory() -> Hands {
    Hands {
        force: Face::Belly.force() + BIAS,
        tilt: [0.04; 4],
        air: Some(101_325.0),
        pads: Some(pads()),
        brown_out_set: false,
        ..Hands::default()
    }
}

/// From the chip to the level table.
fn first_part(builder: &mut Builder, board: &Board) {
    builder.step("chip");
    builder.at("Enter sets it", "");
    builder.step("setup");
    builder.at("Enter keeps motor_protocol", "");
    builder.at("Enter keeps rc_protocol", "");
    builder.at("Enter keeps battery_capacity", "5");
    builder.hears("battery_capacity cannot be 5");
    builder.at("Enter keeps battery_capacity", "5400");
    for name in ["battery_warning", "battery_critical", "infill", "servo_range"] {
        builder.at(&format!("Enter keeps {name}"), "");
    }
    builder.hears("storing");
    builder.step("selftest");
    builder.step("live-air");
    // It is forgotten in the first try.
    for up in [101_325.0, 101_313.0] {
        for (asks, pascal) in [("Lift it by 1 m", up), ("And down again", 101_325.0)] {
            builder.hears(asks);
            board.hands(|hands| hands.air = Some(pascal));
            builder.types("");
        }
        if up > 101_320.0 {
            builder.hears("up by hand +0.0 Pa; 1 m takes 12 off");
            builder.at("Enter tries it again", "");
            builder.at("Enter begins", "");
        }
    }
    builder.hears("up by hand -12.0 Pa");
    builder.step("live-imu");
    builder.hears("Enter once they have followed");
    for side in [Face::Right, Face::Nose] {
        lies(board, side);
        board.pass(6.0);
    }
    builder.types("");
    lies(board, Face::Belly);
    builder.step("live-arms");
    builder.hears("Enter once they have followed");
    board.hands(|hands| hands.tilt = [0.3; 4]);
    board.pass(2.0);
    board.hands(|hands| hands.tilt = [0.04; 4]);
    board.pass(2.0);
    builder.types("");
    builder.step("live-grip");
    builder.hears("Enter once they have followed");
    // One pad is forgotten, and pressed in the second try.
    board.hands(|hands| hands.counts.fsr = [1000, 1000, 0, 1000]);
    board.pass(2.0);
    board.hands(|hands| hands.counts.fsr = [0; 4]);
    board.pass(2.0);
    builder.types("");
    builder.hears("press3 0 to 0; to be moved by 100 at least");
    builder.at("Enter tries it again", "");
    builder.types("");
    builder.hears("Enter once they have followed");
    board.hands(|hands| hands.counts.fsr = [1000; 4]);
    board.pass(2.0);
    board.hands(|hands| hands.counts.fsr = [0; 4]);
    board.pass(2.0);
    builder.types("");
    builder.step("mounting");
    for side in [Face::Belly, Face::Nose, Face::Right] {
        builder.rests(side.text(), || lies(board, side));
    }
    builder.hears("imu_mounting ");
    builder.hears("passed");
    lies(board, Face::Belly);
    builder.step("gyro");
    builder.at("Enter when it is so", "");
    builder.step("level");
    builder.at("Enter for the level table", "");
    builder.at("Enter when it is so", "");
}

/// The arms' sensors from `first` on; that of arm 4 is mounted the other way round.
fn arms(builder: &mut Builder, board: &Board, first: usize) {
    for arm in first..=4 {
        builder.step(&format!("arm-{arm}"));
        builder.at("Enter when it is so", "");
        builder.rests("Bend its tip up", || {
            board.hands(|hands| hands.tilt[arm - 1] += if arm == 4 { -0.3 } else { 0.3 });
            board.pass(1.0);
        });
        builder.hears("passed");
        board.hands(|hands| hands.tilt = [0.04; 4]);
    }
}

/// Stiffness of the arms in torsion over the derived one.
const TORSION: f64 = 0.6;

/// The torsion of arm 2, on the simulator's stand.
fn twists(builder: &mut Builder, board: &Board) {
    let mut scenario = Scenario::default_mission();
    scenario.vehicle.arm_torsion = TORSION;
    let mut stand = TwistStand::new(&scenario, 1, Streams::new(3));
    builder.step("twist");
    builder.at("Which arm", "2");
    builder.hears("Enter when it is so");
    board.hands(|hands| hands.tilt[1] = 0.04 + stand.slope() as f32);
    board.pass(1.0);
    builder.types("");
    builder.at("From the arm's axis", "");
    let loads = [0.03, 0.06, 0.09];
    for load in loads {
        let (weighed, _) = stand.read(load, 0.1);
        builder.at("on a kitchen scale", &format!("{:.0}", 1e3 * weighed));
    }
    for load in [0.0].into_iter().chain(loads).chain(loads.map(|load| -load)) {
        let (_, twist) = stand.read(load, 0.1);
        builder.at("Twist, deg", &format!("{:.1}", twist.to_degrees()));
    }
    builder.hears("vehicle.arm_torsion = ");
    builder.hears("passed");
    board.hands(|hands| hands.tilt = [0.04; 4]);
}

/// The number behind `words` in the protocol.
fn protocol_number(temp: &Temp, words: &str) -> f64 {
    let file = fs::read_to_string(temp.0.join("bringup.toml")).unwrap();
    let (_, after) = file
        .split_once(words)
        .unwrap_or_else(|| panic!("{words}: {file}"));
    after.split([' ', '"']).next().unwrap().parse().unwrap()
}

/// The loads on one pad: what the builder's scale shows as 98, 141 and 199 g, to 1 g and 0.5 % more than there is.
fn loads(builder: &mut Builder, board: &Board, sensor: usize) {
    builder.rests("Nothing may touch the pad", || bends(board, sensor, Pads::BEND));
    for grams in [97.8, 140.1, 198.3, 140.1, 97.8] {
        builder.rests("g, the segment counted", || {
            on_the_pad(board, sensor, grams);
        });
    }
    builder.rests("Take all of it off", || on_the_pad(board, sensor, 0.0));
    builder.hears("out of its cradle");
    bends(board, sensor, 0.0);
    builder.types("");
    builder.hears("hysteresis ");
    builder.hears("loads 98, 141, 199 g");
    builder.hears("passed");
}

fn bends(board: &Board, sensor: usize, bend: f64) {
    board.hands(|hands| hands.pads.as_mut().unwrap().bend[sensor - 1] = bend);
    board.pass(1.0);
}

fn on_the_pad(board: &Board, sensor: usize, grams: f64) {
    board.hands(|hands| {
        let pads = hands.pads.as_mut().unwrap();
        pads.load[sensor - 1] = 1e-3 * grams * f64::from(GRAVITY);
    });
    board.pass(2.0);
}

/// Sliding friction of the dry and of the wet pipe.
const FRICTION: [f64; 2] = [0.42, 0.25];

/// Pulls of a pad along the simulated pipe by a luggage scale to 10 g that shows 1 % too much: 0.43 for 0.42.
fn friction(builder: &mut Builder) {
    builder.at("Three loads in g", "500 1000");
    builder.hears("3 numbers above 0");
    builder.at("Three loads in g", "");
    for (wet, kinetic) in FRICTION.into_iter().enumerate() {
        for grams in [500.0, 500.0, 1000.0, 1000.0, 1500.0, 1500.0] {
            let (starts, slides) = drawn(kinetic, 1.3, 1e-3 * grams * f64::from(GRAVITY));
            let shown = |newton: f64| 1.01 * newton / f64::from(GRAVITY);
            let typed = format!("{:.2} {:.2}", shown(starts), shown(slides));
            builder.at(&format!("{grams} g: kg that start it"), &typed);
        }
        if wet == 0 {
            builder.at("The same on the wet pipe", "y");
        }
    }
    builder.hears("dry pipe: sliding 0.43");
    builder.hears("wet pipe: sliding 0.25");
    builder.hears("passed");
}

/// Sensors of all kinds: sound, late, preloaded, and late with little conductance.
fn pads() -> Pads {
    let sensor = |gain, turn_on, preload, hysteresis| {
        let errors = FsrErrors {
            turn_on,
            preload,
            hysteresis,
            drift: 0.04,
            ..FsrErrors::default()
        };
        (gain, errors)
    };
    Pads {
        seed: 5,
        of: [
            sensor(1.0, 0.0, 0.0, 0.015),
            sensor(1.15, 0.75, 0.05, 0.09),
            sensor(0.9, 0.15, 0.28, 0.06),
            sensor(0.8, 0.4, 0.15, 0.1),
        ],
        load: [0.0; 4],
        bend: [0.0; 4],
    }
}

/// With what is stored each pad reads the grip pressure to 7 %; the late one read half of it before.
fn reads_by_its_line(stored: &Params) {
    for arm in 0..4 {
        let reads = pads().reads(arm, stored, 950.0);
        assert!((reads / 950.0 - 1.0).abs() < 0.07, "pad {}: {reads} Pa", arm + 1);
    }
    let before = pads().reads(1, &Params::DEFAULT, 950.0);
    assert!(before < 0.6 * 950.0, "{before}");
}

/// From the pressure sensors to the rotors.
fn sensors_and_actuators(builder: &mut Builder, board: &Board) {
    for sensor in 1..=4 {
        builder.step(&format!("fsr-{sensor}"));
        if sensor == 1 {
            builder.at("Three loads in g", "140 100 200");
            builder.hears("three that rise");
        }
        builder.at("Three loads in g", if sensor == 1 { "98 141 199" } else { "" });
        loads(builder, board, sensor);
    }
    for servo in 1..=4 {
        builder.step(&format!("servo-{servo}"));
        builder.at("+ or - moves it", "-92");
        builder.at("580 us", "");
        builder.at("full mark", "+185");
        builder.at("2430 us", "");
    }
    for tendon in 1..=4 {
        builder.at(&format!("(tendon-{tendon})"), "s");
    }
    builder.step("flow");
    builder.hears("no flow module: flow_port is none");
    builder.step("friction");
    friction(builder);
    builder.step("battery");
    builder.at("Type off", "yes");
    builder.at("Type off", "off");
    builder.at("Volts that the meter shows", "15.5");
    builder.at("Enter when it is so", "");
    builder.step("esc");
    builder.at("Type off", "off");
    for _ in 0..4 {
        builder.at("Did it turn", "y");
    }
    builder.step("rotors");
    // The wires of 2 and 3 are swapped: once to find it, once to see it right.
    for round in 0..2 {
        for (rotor, way) in [("1", "a"), ("3", "c"), ("2", "c"), ("4", "a")] {
            builder.at("Which rotor turned", rotor);
            builder.at("From above", way);
        }
        if round == 0 {
            builder.hears("motor_map 1234 -> 1324");
            builder.hears("Once more, to see it right");
            builder.at("Type off", "off");
        }
    }
    builder.hears("all rotors as they should");
}

#[test]
fn a_vehicle_is_brought_up_over_four_sessions() {
    let temp = Temp::new("bringup-whole");
    let file = temp.file("key", KEY.as_bytes());
    let board = Board::with_key(factory(), Key::from_hex(KEY));
    brought_up(&temp, &board, &["--mavlink-key", &file]);

    // What the board has lost is asked again, and nothing else.
    let mut lost = board.stored();
    lost.set("fsr_zero_2", 1.0).unwrap();
    lost.set("servo_marks", 134.0).unwrap();
    let board = Board::with_stored(
        Hands {
            brown_out_set: true,
            ..factory()
        },
        lost,
    );
    let done = run(&temp, &["bringup", "--port", &board.name()]);
    assert_eq!(done.status, Some(1));
    assert!(
        done.said
            .contains("fsr-2 is to be done again: fsr_zero_2 is 1 at the board, was "),
        "{done:?}"
    );
    assert!(done.said.contains("not done: fsr-2, servo-2\n"), "{done:?}");
}

#[test]
fn a_line_that_loses_frames_and_bytes_only_takes_longer() {
    let temp = Temp::new("bringup-lossy");
    let board = Board::new(Hands {
        drops: Some(17),
        loses: Some(701),
        ..factory()
    });
    let mut builder = Builder::begins(&temp, &board, &[]);
    builder.hears("on table, chip 0x450 0x2003");
    first_part(&mut builder, &board);
    builder.at("(arm-1)", "q");
    let (status, said, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(1), ""), "{said}");
    assert!(said.contains("\nStopped. not done: arm-1, arm-2"), "{said}");
    let file = fs::read_to_string(temp.0.join("bringup.toml")).unwrap();
    let rows = file.matches("pass  ").count() + file.matches("FAIL  ").count();
    assert_eq!(rows, usize::from(ROWS), "{file}");
    assert!((board.stored().accel_bias_x - 0.11).abs() < 1e-3);
    assert!((board.stored().battery_capacity - 5400.0).abs() < 1.0);
}

#[test]
fn a_barometer_that_a_board_carries_is_missed() {
    let temp = Temp::new("bringup-air");
    let board = Board::new(Hands {
        board: "matek-h743",
        ..Hands::default()
    });
    let mut builder = Builder::begins(&temp, &board, &[]);
    for id in ["chip", "setup", "selftest"] {
        builder.at(&format!("({id})"), "s");
    }
    builder.step("live-air");
    builder.hears("no barometer answers on matek-h743, which carries one");
    builder.hears("FAILED");
    builder.at("Enter tries it again", "");
    board.hands(|hands| hands.air = Some(101_325.0));
    board.pass(0.5);
    builder.types("");
    builder.hears("Lift it by 1 m");
    board.hands(|hands| hands.air = None);
    builder.types("");
    builder.at("And down again", "");
    builder.hears("barometer fell silent while it was lifted");
    builder.at("Enter tries it again", "q");
    assert_eq!(builder.ends().0, Some(1));
}

#[test]
fn a_slow_board_s_barometer_is_not_silent_for_being_late() {
    let temp = Temp::new("bringup-late");
    let board = Board::new(Hands {
        board: "matek-h743",
        ..Hands::default()
    });
    let mut builder = Builder::patient(&temp, &board, "100", &[]);
    for id in ["chip", "setup", "selftest"] {
        builder.at(&format!("({id})"), "s");
    }
    builder.step("live-air");
    builder.hears("Leave it at rest");
    // Longer than the silence of a board that keeps up, which is 3 s.
    std::thread::sleep(Duration::from_secs_f32(3.5));
    board.hands(|hands| hands.air = Some(101_325.0));
    builder.at("Lift it by 1 m", "q");
    assert_eq!(builder.ends().0, Some(1));
}

fn brought_up(temp: &Temp, board: &Board, more: &[&str]) {
    let mut builder = Builder::begins(temp, board, more);
    builder.hears("on table, chip 0x450 0x2003");
    first_part(&mut builder, board);
    builder.at("(arm-1)", "q");
    let (status, said, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(1), ""), "{said}");
    assert!(said.contains("\nStopped. not done: arm-1, arm-2"), "{said}");
    assert!(
        !said.contains('\x1b') && said.lines().all(|line| line.len() <= 79),
        "{said}"
    );
    let file = || fs::read_to_string(temp.0.join("bringup.toml")).unwrap();
    assert!(
        file().contains("id = \"level\"") && file().contains("accel_bias_x = 0.11"),
        "{}",
        file()
    );
    assert!((board.stored().accel_bias_x - 0.11).abs() < 1e-3);
    assert!((board.stored().battery_capacity - 5400.0).abs() < 1.0);

    // The line is lost in the midst of a step.
    let mut builder = Builder::begins(temp, board, more);
    arms(&mut builder, board, 1);
    twists(&mut builder, board);
    let torsion = protocol_number(temp, "vehicle.arm_torsion = ");
    assert!((torsion / TORSION - 1.0).abs() < 0.05, "{torsion}");
    builder.step("fsr-1");
    builder.at("Three loads in g", "");
    builder.at("Enter when it is so", "");
    builder.hears("Put on 100 g");
    board.hands(|hands| hands.mute = true);
    builder.at("Enter when it is so", "");
    let (status, _, complaint) = builder.ends();
    assert_eq!(status, Some(1));
    assert!(
        complaint.contains("fell silent for 5 s after SOPHIE_CALIBRATE"),
        "{complaint}"
    );
    board.hands(|hands| hands.mute = false);
    let stored = board.stored();
    assert_eq!(
        (stored.get("arm_sign_1"), stored.get("arm_sign_4")),
        (Some(1.0), Some(-1.0))
    );

    // The input ends with the radio's step; a step is skipped.
    let mut builder = Builder::begins(temp, board, more);
    builder.hears("not done: fsr-1");
    sensors_and_actuators(&mut builder, board);
    builder.at("(radio)", "s");
    builder.hears("skipped");
    builder.hears("(thrust)");
    let (status, said, _) = builder.ends();
    assert!(
        status == Some(1) && said.contains("\nStopped. skipped: radio; not done: thrust, "),
        "{said}"
    );

    let mut builder = Builder::begins(temp, board, more);
    builder.at("(radio)", "");
    builder.at("Type off", "off");
    // Nothing is moved: it fails, and is left for a second try.
    board.hands(|hands| hands.sticks = Some(Sticks::default()));
    board.pass(1.0);
    builder.at("Enter once they have followed", "");
    builder.hears("thrott 0 to 0; 0.02 to 0.95 at least");
    builder.at("Enter tries it again", "");
    board.pass(1.0);
    builder.types("");
    radio(&mut builder, board);
    let tied = STEPS.iter().skip_while(|step| step.id != "radio").skip(1);
    for step in tied.take_while(|step| step.id != "final") {
        builder.at(&format!("({})", step.id), "s");
        builder.hears("left out");
    }
    builder.step("final");
    let (status, said, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(0), ""), "{said}");
    let state = "left out: tendon-1, tendon-2, tendon-3, tendon-4, thrust, lag, arm-table, vibration";
    assert!(said.replace("\n  ", " ").contains(state), "{said}");
    assert!(
        file().contains(&format!("all steps passed, {state}")),
        "{}",
        file()
    );
    assert_eq!(board.stored().motor_map.number(), 1324.0);
    reads_by_its_line(&board.stored());
    // The wet pipe's, which is the worse one.
    let found = f64::from(board.stored().pipe_friction);
    assert!((found / FRICTION[1] - 1.0).abs() < 0.03, "{found}");
    let build = "build 1234abcd, ";
    assert_eq!(file().matches(build).count(), 1 + STEPS.len(), "{}", file());
    let name = board.name();
    // Another image: said in one line, and nothing is asked again.
    board.hands(|hands| (hands.build, hands.power_cycle) = (0xC0DE, true));
    let done = run(temp, &[&["bringup", "--port", &name], more].concat());
    assert!(
        done.status == Some(0)
            && done
                .said
                .contains("\nAnother image than before: the last run was at build 1234abcd, ")
            && done
                .said
                .replace("\n  ", " ")
                .contains(" this board has build 0000c0de, "),
        "{done:?}"
    );
    // Nothing is asked again.
    let done = run(temp, &[&["bringup", "--port", &name], more].concat());
    assert!(
        done.status == Some(0) && !done.said.contains("(chip)") && !done.said.contains("Another image"),
        "{done:?}"
    );
}

/// Sticks to their ends, switches through their positions, then the transmitter off and on.
fn radio(builder: &mut Builder, board: &Board) {
    let ends = |sign: f32, on: bool| Sticks {
        roll: sign,
        pitch: sign,
        yaw: sign,
        throttle: 1.0,
        arm_switch: on,
        perch_switch: on,
        stick_mode: if on { StickMode::Direct } else { StickMode::Angle },
        hold_switch: on,
        arms: if on { ArmChoice::Rear } else { ArmChoice::All },
    };
    builder.hears("Enter once they have followed");
    for sticks in [ends(1.0, true), ends(-1.0, false), Sticks::default()] {
        board.hands(|hands| hands.sticks = Some(sticks));
        board.pass(1.0);
    }
    builder.types("");
    builder.hears("switch the transmitter off");
    board.hands(|hands| hands.sticks = None);
    builder.types("");
    builder.hears("on again");
    board.hands(|hands| hands.sticks = Some(Sticks::default()));
    builder.types("");
}

#[test]
fn a_file_that_is_no_protocol_is_left_alone() {
    let (temp, board) = (Temp::new("bringup-file"), Board::new(Hands::default()));
    let name = board.name();
    let tried = |file: &str| run(&temp, &["bringup", "--port", &name, "--protocol", file]);
    for (text, why) in [
        ("[params]\ninfill = 8\n", "is no protocol of a bring-up: "),
        ("not toml", "is no protocol of a bring-up: "),
    ] {
        temp.file("p.toml", text.as_bytes());
        tried("p.toml").complains(2, why);
        assert_eq!(fs::read_to_string(temp.0.join("p.toml")).unwrap(), text);
    }
    tried("nowhere/p.toml").complains(2, "nowhere/p.toml: cannot be written");
    tried(".").complains(2, ".: is no file");
    // That of another board.
    assert_eq!(tried("mine.toml").status, Some(1));
    let mine = fs::read_to_string(temp.0.join("mine.toml")).unwrap();
    temp.file("other.toml", mine.replace("on table", "on f405").as_bytes());
    tried("other.toml").complains(2, "on f405, 0x450 0x2003; this is SOPHIE");
    let line = refused(&temp, &["bringup", "--port", "tcp:127.0.0.1:1"]);
    assert!(line.contains("tcp:127.0.0.1:1: cannot be opened"), "{line}");
    assert!(!temp.0.join("bringup.toml").exists());
    run(&temp, &["bringup", "--port", &name, "--again", "arm-5"])
        .complains(2, "--again arm-5: allowed chip, setup");
}

#[test]
fn a_board_that_refuses_fails_the_step() {
    let (temp, board) = (Temp::new("bringup-refused"), Board::new(Hands::default()));
    let mut builder = Builder::begins(&temp, &board, &[]);
    builder.step("chip");
    for id in [
        "setup",
        "selftest",
        "live-air",
        "live-imu",
        "live-arms",
        "live-grip",
        "mounting",
        "gyro",
    ] {
        builder.at(&format!("({id})"), "s");
    }
    builder.at("(level)", "");
    // Far from level.
    board.hands(|hands| hands.force = Face::Belly.force() + Vec3::new(0.0, 0.85, 0.0));
    board.pass(1.0);
    builder.at("Enter for the level table", "");
    builder.at("Enter when it is so", "");
    builder.hears("not taken: bias along y is 0.85");
    builder.hears("FAILED");
    builder.at("Enter tries it again", "s");
    builder.at("(arm-1)", "");
    // It is not bent.
    builder.at("Enter when it is so", "");
    builder.at("Enter when it is so", "");
    builder.hears("not taken: turn of the arm is 0.0");
    builder.hears("FAILED");
    builder.at("Enter tries it again", "q");
    let (status, said, _) = builder.ends();
    assert_eq!(status, Some(1));
    assert!(
        said.contains("Stopped. failed: level, arm-1; skipped: setup, selftest"),
        "{said}"
    );
    assert!(board.stored() == Params::DEFAULT);
}
