//! What the console obeys and answers, typed line by line.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use embassy_time::{Duration, Instant};
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_control::battery::Battery;
use sophie_control::maths::vector::Vec3;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::Params;
use sophie_control::vibration::Vibration;
use sophie_mavlink::inputs::Counts;
use sophie_mavlink::wire::signing::Refused;
use sophie_ports::chip::{Chip, NotSet};
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::error::PortError;
use sophie_ports::receiver::RcState;
use sophie_ports::serial::SerialOutput;
use sophie_ports::signing::{Key, Record, Stored};
use sophie_ports::storage::{Loaded, Storage, StorageError};
use sophie_tasks::console;
use sophie_tasks::links::Links;
use sophie_tasks::links::mavlink_line::{LineState, SigningState};
use sophie_tasks::links::messages::Status;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::schedule::timing::Run;

use crate::rig::Rig;
use sophie_fakes::FakeLine;

/// A screen that takes everything at once.
#[derive(Clone, Default)]
pub struct Screen(pub Rc<RefCell<String>>);

impl SerialOutput for Screen {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        self.0.borrow_mut().push_str(str::from_utf8(bytes).unwrap());
        Ok(())
    }
}

/// Storage and restart that remember.
#[derive(Clone, Default)]
pub struct Board {
    pub stored: Rc<Cell<Option<Params>>>,
    pub restarts: Rc<Cell<u32>>,
    /// Times that the chip's loader was entered.
    pub loads: Rc<Cell<u32>>,
    /// MAVLink's key.
    pub signing: Rc<Cell<Option<Record>>>,
    /// What the board's own defaults are; the table's without.
    defaults: Option<&'static Params>,
}

impl Storage for Board {
    fn defaults(&self) -> &'static Params {
        self.defaults.unwrap_or(&Params::DEFAULT)
    }

    async fn load(&mut self, _params: &mut Params) -> Loaded {
        Loaded {
            signing: self.signing.get().map_or(Stored::None, Stored::Key),
            ..Loaded::default()
        }
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        self.stored.set(Some(*params));
        Ok(())
    }

    async fn save_signing(&mut self, signing: Option<Record>) -> Result<(), StorageError> {
        self.signing.set(signing);
        Ok(())
    }
}

impl Chip for Board {
    fn restart(&mut self) {
        self.restarts.set(self.restarts.get() + 1);
    }

    fn enter_loader(&mut self) {
        self.loads.set(self.loads.get() + 1);
    }

    fn board(&self) -> &'static str {
        "table"
    }

    fn build(&self) -> u32 {
        0x1234_ABCD
    }

    fn checks(&self) -> &[ChipCheck] {
        &[]
    }

    fn brown_out_volts(&self) -> f32 {
        2.7
    }

    async fn set_brown_out(&mut self) -> Result<(), NotSet> {
        Err(NotSet)
    }
}

pub struct Bench {
    pub rig: Rig,
    pub line: FakeLine,
    pub screen: Screen,
    pub board: Board,
    /// What the commander says at 100 Hz; `None`: nothing.
    status: Option<Status>,
}

impl Bench {
    pub fn in_mode(mode: Mode) -> Self {
        Self::of(mode, Board::default(), Params::DEFAULT)
    }

    fn of(mode: Mode, board: Board, params: Params) -> Self {
        let rig = Rig::with(params);
        let (line, screen) = (FakeLine::default(), Screen::default());
        rig.time.spawn(console::run(
            rig.links,
            line.clone(),
            screen.clone(),
            board.clone(),
            board.clone(),
        ));
        let status = Status {
            mode,
            ..Status::default()
        };
        Self {
            rig,
            line,
            screen,
            board,
            status: Some(status),
        }
    }

    pub fn run(&mut self, ms: u64) {
        let status = self.status;
        let mut i = 0;
        self.rig.run_with(ms, |links: &Links, at| {
            if let (Some(status), 0) = (status, i % 10) {
                links.status.send(at, status);
            }
            i += 1;
        });
    }

    /// What holds until a restart ends.
    fn restarts(&self) {
        self.rig.links.report(ArmingInhibit::Storing, false);
    }

    /// The lines of the answer, without what was typed and the prompt.
    fn says(&mut self, text: &str) -> Vec<String> {
        self.run(20);
        self.screen.0.take();
        self.line.put(format!("{text}\r").as_bytes());
        self.run(600);
        let screen = self.screen.0.take();
        let answer = screen.strip_suffix("> ").expect("a prompt at the end");
        answer
            .split_terminator("\r\n")
            .skip(1)
            .map(String::from)
            .collect()
    }
}

#[test]
fn nothing_is_restarted_or_stored_but_while_the_motors_stand() {
    for mode in Mode::ALL {
        let allowed = matches!(mode, Mode::Disarmed | Mode::Calibrating);
        let mut bench = Bench::in_mode(mode);
        let said = bench.says("restart");
        assert_eq!(bench.board.restarts.get(), u32::from(allowed), "{mode:?}");
        let refused = format!("while {}: disarm first", mode.name());
        if allowed {
            assert_eq!(said, ["restarting"]);
        } else {
            assert_eq!(said, [format!("not restarted {refused}")]);
        }
        let mut bench = Bench::in_mode(mode);
        bench.says("set infill 8");
        let said = bench.says("save");
        let stored = bench.board.stored.take().map(|params| params.infill);
        assert_eq!(stored, allowed.then_some(8.0), "{mode:?}");
        assert_eq!(bench.board.restarts.get(), u32::from(allowed), "{mode:?}");
        // After a save arming stays refused until the restart.
        assert_eq!(
            bench.rig.links.hardware().contains(ArmingInhibit::Storing),
            allowed
        );
        if !allowed {
            assert_eq!(said, [format!("not saved {refused}")]);
        }
        let mut bench = Bench::in_mode(mode);
        let said = bench.says("dfu");
        assert_eq!(bench.board.loads.get(), u32::from(allowed), "{mode:?}");
        assert_eq!(bench.board.restarts.get(), 0);
        // Nor may it be armed on the way.
        let held = bench.rig.links.hardware().contains(ArmingInhibit::Storing);
        assert_eq!(held, allowed);
        if !allowed {
            assert_eq!(said, [format!("not left {refused}")]);
        }
    }
    // A commander that is silent may be flying.
    let mut bench = Bench::in_mode(Mode::Disarmed);
    bench.run(100);
    bench.status = None;
    bench.run(300);
    assert_eq!(bench.says("restart"), ["not restarted: the commander is silent"]);
    assert_eq!(bench.says("save"), ["not saved: the commander is silent"]);
    assert_eq!(bench.says("dfu"), ["not left: the commander is silent"]);
    assert_eq!(bench.board.loads.get(), 0);
    assert!(bench.board.restarts.get() == 0 && bench.board.stored.get().is_none());
}

#[test]
fn a_parameter_is_shown_changed_counted_and_put_back() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    assert_eq!(bench.says("changes"), ["no changes"]);
    assert_eq!(
        bench.says("set infill 8"),
        ["infill 6.9 -> 8 %, in force after save"]
    );
    assert_eq!(
        bench.says("changes"),
        ["infill 6.9 -> 8 %", "1 change, in force after save"]
    );
    let row = &bench.says("get infill")[..2];
    assert!(row[0].starts_with("* infill ") && row[0].contains(" 8 ") && row[0].ends_with("4 to 10 %"));
    assert_eq!(row[1], "  default 6.9");
    bench.says("set gain_k 5");
    assert_eq!(
        bench.says("changes").last().unwrap(),
        "2 changes, in force after save"
    );
    assert_eq!(bench.says("reset infill"), ["infill 8 -> 6.9 %, as in force"]);
    assert_eq!(bench.says("changes").len(), 2);
    assert!(bench.says("get infill")[0].starts_with("  infill "));
    assert_eq!(bench.says("defaults"), ["no changes"]);
}

#[test]
fn what_is_not_allowed_or_not_known_is_answered_with_what_is() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    for (typed, said) in [
        ("set infill 11", "infill cannot be 11; it takes 4 to 10 %"),
        (
            "set infill soft",
            "'soft' is not a number; infill takes 4 to 10 %",
        ),
        ("set infil 8", "no parameter 'infil'; did you mean 'infill'?"),
        ("get zzzzzzzz", "no parameter 'zzzzzzzz'; 'list' shows them all"),
        ("list zzzz", "no parameter has 'zzzz' in its name"),
        ("sav", "no command 'sav'; did you mean 'save'?"),
        ("xyzzy", "no command 'xyzzy'; try 'help'"),
        ("set infill", "say 'set NAME VALUE'"),
    ] {
        assert_eq!(bench.says(typed), [said], "{typed}");
    }
    assert_eq!(bench.says("changes"), ["no changes"]);
    // Those with the name's part, and no others.
    let listed = bench.says("list estimator_");
    assert_eq!(listed.len(), 2);
    assert!(listed[0].starts_with("  estimator_kp ") && listed[1].starts_with("  estimator_ki "));
    assert_eq!(bench.says("list").len(), Params::TABLE.len());
    assert_eq!(
        bench.says("version"),
        [
            concat!("SOPHIE ", env!("CARGO_PKG_VERSION"), " on table"),
            &format!(
                "build 1234abcd, {} parameters, table {:08x}",
                Params::TABLE.len(),
                sophie_tasks::storage::parameters::table_id()
            )
        ]
    );
    assert_eq!(bench.says("help").len(), 26);
}

#[test]
fn status_says_how_the_vehicle_is() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    // An hour, two minutes and three seconds, less what `says` takes.
    bench.rig.run(3_723_000);
    let silent = bench.says("status");
    assert_eq!(
        silent,
        [
            "DISARMED",
            "nothing forbids arming",
            "battery not measured",
            "receiver silent since the start",
            "up for 1:02:03"
        ]
    );
    let links = bench.rig.links;
    let state = RcState {
        frames: 70,
        errors: 3,
        ..RcState::default()
    };
    links.rc.send(Instant::now(), state);
    bench.run(600);
    // 3600 A s are 1000 mAh.
    let battery = Battery {
        voltage: 15.678,
        current: Some(2.46),
        used: Some(3600.0),
        ratio: 1.0,
    };
    let at = Instant::now() + Duration::from_millis(300);
    links.battery.send(at, battery);
    let inhibits = ArmingInhibits::NONE
        .with(ArmingInhibit::BatteryLow)
        .with(ArmingInhibit::RcLost);
    bench.status = Some(Status {
        mode: Mode::Disarmed,
        reason: Some(Reason::RADIO_LOST),
        warning: "infill below what was flown",
        inhibits,
    });
    bench.says("set infill 8");
    links
        .battery
        .send(Instant::now() + Duration::from_millis(300), battery);
    assert_eq!(
        bench.says("status"),
        [
            "DISARMED: radio lost",
            "warning: infill below what was flown",
            "arming refused: radio lost",
            "arming refused: battery low",
            "battery 15.68 V, 2.5 A, 1000 mAh used",
            "receiver 70 frames, 3 errors, silent now",
            "up for 1:02:04",
            "1 change is not saved"
        ]
    );
    let vibration = Vibration {
        rms: Vec3::new(1.25, 0.5, 10.0),
        clipped: 3,
    };
    links.vibration.send(Instant::now(), vibration);
    let shaking = "vibration 1.2 0.5 10.0 m/s2 (7 at most in flight), 3 readings clipped";
    assert!(
        bench
            .says("status")
            .iter()
            .any(|line| line.replace("1.3", "1.2") == shaking)
    );
    // Nothing forbids it in a mode that is armed, and nothing is said of it.
    bench.status = Some(Status {
        mode: Mode::Flight,
        ..Status::default()
    });
    assert_eq!(bench.says("status")[..1], ["FLIGHT"]);
    assert!(!bench.says("status").contains(&"nothing forbids arming".into()));
    bench.status = None;
    bench.run(300);
    assert_eq!(bench.says("status")[0], "the commander is silent");
}

#[test]
fn timing_has_a_line_for_every_task_and_the_contact_chain() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    bench.rig.run(4_980);
    for _ in 0..500 {
        let run = Run {
            released: Instant::from_micros(0),
            started: Instant::from_micros(30),
            ended: Instant::from_micros(250),
            deadline: Duration::from_micros(240),
            skipped: 0,
        };
        bench.rig.links.timing.record(TaskId::Clamp, &run);
    }
    // 500 runs in 5.00 s; every one late.
    let said = bench.says("timing");
    assert_eq!(said.len(), 2 + TaskId::COUNT);
    assert!(said[1 + TaskId::COUNT].starts_with("contact "), "{said:?}");
    let row: Vec<&str> = said[7].split_whitespace().collect();
    assert_eq!(row, ["clamp", "100", "30", "250", "220", "500"]);
}

#[test]
fn a_boards_own_defaults_are_its_defaults_on_every_command() {
    static CUAV: Params = Params {
        battery_divider: 18.0,
        battery_a_per_v: 24.0,
        ..Params::DEFAULT
    };
    let board = Board {
        defaults: Some(&CUAV),
        ..Board::default()
    };
    let mut bench = Bench::of(Mode::Disarmed, board, CUAV);
    assert_eq!(
        bench.says("list battery_a"),
        ["  battery_a_per_v  24        1 to 1000 A/V"]
    );
    // The table's default is a value like any other here.
    let changed = "battery_a_per_v 24 -> 40 A/V, in force after save";
    assert_eq!(bench.says("set battery_a_per_v 40"), [changed]);
    let said = bench.says("get battery_a_per_v");
    assert_eq!(
        said[..2],
        ["* battery_a_per_v  40        1 to 1000 A/V", "  default 24"]
    );
    assert_eq!(
        bench.says("reset battery_a_per_v"),
        ["battery_a_per_v 40 -> 24 A/V, as in force"]
    );
    bench.says("set battery_divider 11");
    bench.says("set infill 8");
    assert_eq!(bench.says("defaults"), ["no changes"]);
    for nonsense in ["0", "-18", "0.5", "61", "NaN", "inf"] {
        let said = bench.says(&format!("set battery_divider {nonsense}"));
        assert!(said[0].contains("1 to 60"), "{said:?}");
    }
    assert_eq!(bench.says("changes"), ["no changes"]);
}

#[test]
fn old_names_and_units_are_taken_with_a_line_that_has_the_new_ones() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    for (typed, answers) in [
        (
            "set receiver_protocol 1",
            [
                "receiver_protocol is rc_protocol now",
                "rc_protocol 0 crsf -> 1 sbus, in force after save",
            ],
        ),
        (
            "set setpoint_cutoff 20",
            [
                "setpoint_cutoff in rad/s is setpoint_lpf_hz in Hz now",
                "setpoint_lpf_hz 1.5915494 -> 3.183099 Hz, in force after save",
            ],
        ),
        (
            "set perch_throttle_max 0.7",
            [
                "perch_throttle_max is perch_thr_max now",
                "perch_thr_max cannot be 0.7; it takes 0.1 to 0.6",
            ],
        ),
        (
            "reset setpoint_cutoff",
            [
                "setpoint_cutoff in rad/s is setpoint_lpf_hz in Hz now",
                "setpoint_lpf_hz 3.183099 -> 1.5915494 Hz, as in force",
            ],
        ),
    ] {
        assert_eq!(bench.says(typed), answers, "{typed}");
    }
    let listed = bench.says("list setpoint_cutoff");
    assert!(
        listed.len() == 1 && listed[0].contains("setpoint_lpf_hz"),
        "{listed:?}"
    );
    assert_eq!(
        bench.says("get receiver_protocol")[..3],
        [
            "receiver_protocol is rc_protocol now",
            "* rc_protocol      1         crsf, sbus",
            "  default 0 crsf"
        ]
    );
}

#[test]
fn enumerated_values_have_a_number_and_a_name() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    let protocols = "one of 125 oneshot125, 150 dshot150, 300 dshot300, 400 pwm, 600 dshot600";
    for (typed, answer) in [
        (
            "set motor_protocol pwm",
            "motor_protocol 300 dshot300 -> 400 pwm, in force after save",
        ),
        (
            "set motor_protocol 300",
            "motor_protocol 400 pwm -> 300 dshot300, as in force",
        ),
        (
            "set motor_protocol dshot",
            &format!("'dshot' is not a value; motor_protocol takes {protocols}"),
        ),
        (
            "set motor_protocol 1e9",
            &format!("motor_protocol cannot be 1e9; it takes {protocols}"),
        ),
        (
            "set rc_protocol 0.4",
            "rc_protocol cannot be 0.4; it takes one of 0 crsf, 1 sbus",
        ),
    ] {
        assert_eq!(bench.says(typed), [answer], "{typed}");
    }
}

/// 64 digits.
const KEY: &str = "000102030405060708090a0b0c0d0e0f101112131415161718191a1b1c1d1e1f";

#[test]
fn a_key_is_stored_and_in_force_after_a_restart_while_disarmed_alone() {
    for mode in Mode::ALL {
        let allowed = matches!(mode, Mode::Disarmed | Mode::Calibrating);
        let mut bench = Bench::in_mode(mode);
        let said = bench.says(&format!("mavlink key {KEY}"));
        let stored = bench.board.signing.get();
        assert_eq!(
            stored,
            allowed.then_some(Record::fresh(Key::from_hex(KEY).unwrap()))
        );
        assert_eq!(bench.board.restarts.get(), u32::from(allowed), "{mode:?}");
        if allowed {
            assert_eq!(said, ["signing on; restarting"]);
            bench.restarts();
            assert_eq!(bench.says("mavlink key off"), ["signing off; restarting"]);
            assert_eq!(bench.board.signing.get(), None);
        } else {
            assert_eq!(said, [format!("not set while {}: disarm first", mode.name())]);
        }
    }
}

#[test]
fn a_save_that_may_lose_a_key_says_so() {
    for (signing, lost) in [
        (SigningState::Off, false),
        (SigningState::On, false),
        (SigningState::Unknown, true),
        (SigningState::Lost, false),
    ] {
        let mut bench = Bench::in_mode(Mode::Disarmed);
        bench.run(20);
        bench.line.put(b"save\r");
        let state = LineState {
            signing,
            refused: Refused::default(),
            inputs: Counts::default(),
        };
        bench.rig.links.mavlink.send(Instant::now(), state);
        bench.run(600);
        let said = bench.screen.0.take();
        assert!(said.contains("saved; restarting"), "{said}");
        let warned =
            said.contains("MAVLink's key, if there was one, is lost: set it again, or 'mavlink key off'");
        assert_eq!(warned, lost, "{said}");
    }
}

#[test]
fn a_key_is_checked_and_never_shown() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    for wrong in [&KEY[1..], "on", &KEY.replace('0', "x")] {
        let said = bench.says(&format!("mavlink key {wrong}"));
        assert_eq!(said, ["not set: a key is 64 hexadecimal digits, or off"]);
    }
    // What is not saved would be lost.
    bench.says("set infill 8");
    let said = bench.says(&format!("mavlink key {KEY}"));
    assert_eq!(said, ["not set: 'save' or 'reset' what 'changes' shows first"]);
    assert!(bench.board.signing.get().is_none() && bench.board.restarts.get() == 0);
    bench.says("reset infill");
    bench.says(&format!("mavlink key {KEY}"));
    assert!(bench.board.signing.get().is_some());
    for command in [
        "help",
        "status",
        "list",
        "changes",
        "mavlink",
        "version",
        "get infill",
        "mavlink key",
    ] {
        let said = bench.says(command).concat();
        assert!(
            !said.contains(&KEY[2..8]) && !said.contains("1, 2, 3"),
            "{command}: {said}"
        );
    }
}

#[test]
fn the_same_key_again_keeps_what_it_has_taken() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    let record = Record {
        key: Key::from_hex(KEY).unwrap(),
        bound: 77,
    };
    bench.board.signing.set(Some(record));
    bench.says(&format!("mavlink key {KEY}"));
    assert_eq!(bench.board.signing.get(), Some(record));
    bench.restarts();
    let other = KEY.replace('f', "e");
    bench.says(&format!("mavlink key {other}"));
    assert_eq!(bench.board.signing.get().map(|record| record.bound), Some(0));
}

#[test]
fn the_state_of_the_mavlink_line_is_shown() {
    let mut bench = Bench::in_mode(Mode::Disarmed);
    assert_eq!(bench.says("mavlink"), ["the MAVLink task is silent"]);
    let state = LineState {
        signing: SigningState::On,
        refused: Refused {
            unsigned: 3,
            wrong: 2,
            old: 1,
        },
        inputs: Counts {
            poses: 9,
            views: 8,
            targets: 7,
            system: 5,
            source: 4,
            frame: 3,
            value: 2,
            late: 1,
        },
    };
    bench.run(10);
    bench.line.put(b"mavlink\r");
    bench.rig.links.mavlink.send(Instant::now(), state);
    bench.run(50);
    let screen = bench.screen.0.take();
    assert!(
        screen.contains("signing on\r\nrefused: 3 unsigned, 2 with a wrong signature, 1 old or repeated\r\n"),
        "{screen}"
    );
    let inputs = "inputs: 9 poses, 8 of flow and range, 7 of the pipe; refused 5 system, 4 source, 3 frame, 2 value, 1 late\r\n";
    assert!(screen.contains(inputs), "{screen}");
}
