//! Console sessions: input and answers.

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use embassy_futures::yield_now;
use embassy_time::{Instant, Timer};
use sophie_control::arming::ArmingInhibit;
use sophie_control::mode::{Mode, Reason};
use sophie_control::params::{Params, ServoMarks};
use sophie_drivers::param_store::ParamStore;
use sophie_fakes::{Answer, BrokenLine, FakeAnalog, FakeChip, FakeImu, FakeLine, FakeServos, Flash, Part};
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::error::PortError;
use sophie_ports::sensors::AnalogFrame;
use sophie_ports::serial::SerialOutput;
use sophie_ports::signing::Record;
use sophie_ports::stack_use::StackUse;
use sophie_ports::storage::{Loaded, Storage, StorageError};
use sophie_sim::clock::VirtualTime;
use sophie_tasks::console;
use sophie_tasks::flight::{estimator, imu};
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::Status;
use sophie_tasks::perching::{analog, clamp, servos};
use sophie_tasks::pilot::commander;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::storage::parameters;

/// A terminal at 115,200 baud, or one that accepts no bytes.
#[derive(Clone, Default)]
struct Screen {
    text: Rc<RefCell<String>>,
    hangs: Rc<Cell<bool>>,
}

impl SerialOutput for Screen {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        if self.hangs.get() {
            std::future::pending::<()>().await;
        }
        Timer::after_micros(87 * bytes.len() as u64).await;
        self.text.borrow_mut().push_str(str::from_utf8(bytes).unwrap());
        Ok(())
    }
}

/// Brown-out checks of a start-up with `level` of 3.
fn checks(level: u8) -> [ChipCheck; 2] {
    let look = |name, read: String, expected, ok, refuses| ChipCheck {
        name,
        read: read.as_str().try_into().unwrap(),
        expected,
        ok,
        inhibits: refuses,
    };
    [
        look(
            "flash wait states",
            "5".into(),
            "5",
            true,
            Some(ArmingInhibit::Silicon),
        ),
        look(
            "brown-out level",
            level.to_string(),
            "3",
            level == 3,
            Some(ArmingInhibit::BrownOutLevel),
        ),
    ]
}

/// A chip at brown-out `level`, with its start-up checks.
fn chip_at(level: u8) -> FakeChip {
    let chip = FakeChip {
        checks: checks(level).into(),
        ..FakeChip::default()
    };
    chip.level.set(level);
    chip
}

/// Saved parameters, and the commander's status then.
type Saves = Rc<RefCell<Vec<(Params, Option<Status>)>>>;

#[derive(Clone)]
struct FakeStorage {
    answer: Result<(), StorageError>,
    saves: Saves,
    links: &'static Links,
    hangs: bool,
}

impl Storage for FakeStorage {
    async fn load(&mut self, _params: &mut Params) -> Loaded {
        Loaded::default()
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        let status = self.links.status.fresh();
        self.saves.borrow_mut().push((*params, status));
        if self.hangs {
            std::future::pending::<()>().await;
        }
        self.answer
    }

    async fn save_signing(&mut self, _signing: Option<Record>) -> Result<(), StorageError> {
        self.answer
    }
}

struct Bench {
    time: VirtualTime,
    links: &'static Links,
    line: FakeLine,
    screen: Screen,
    chip: FakeChip,
    ms: u64,
}

impl Bench {
    fn new(params: Params) -> Self {
        Self {
            time: VirtualTime::new(),
            links: Box::leak(Box::new(Links::new(params))),
            line: FakeLine::default(),
            screen: Screen::default(),
            chip: chip_at(3),
            ms: 0,
        }
    }

    fn console(self, storage: impl Storage + 'static) -> Self {
        let (links, line, screen) = (self.links, self.line.clone(), self.screen.clone());
        self.time
            .spawn(console::run(links, line, screen, storage, self.chip.clone()));
        self
    }

    /// In `mode`, and in `then` from the save request on.
    fn commander(self, mode: Mode, then: Mode) -> Self {
        let links = self.links;
        self.time.spawn(async move {
            loop {
                let inhibits = links.hardware();
                let storing = inhibits.contains(ArmingInhibit::Storing);
                let status = Status {
                    mode: if storing { then } else { mode },
                    reason: inhibits.first().map(Reason::Check),
                    inhibits,
                    ..Status::default()
                };
                links.status.send(Instant::now(), status);
                Timer::after_millis(10).await;
            }
        });
        self
    }

    fn fake_storage(self, answer: Result<(), StorageError>) -> (Self, FakeStorage) {
        let storage = FakeStorage {
            answer,
            saves: Rc::default(),
            links: self.links,
            hangs: false,
        };
        (self.console(storage.clone()), storage)
    }

    fn run(&mut self, ms: u64) {
        self.ms += ms;
        self.time.run_until(self.ms * 1000);
    }

    /// Returns the new text on the screen.
    fn types(&mut self, text: &str) -> String {
        self.line.put(text.as_bytes());
        self.run(1500);
        self.screen.text.take().replace("\r\n", "\n")
    }
}

fn flash() -> Flash<32, 2048> {
    Flash::blank(2)
}

fn store(flash: &Flash<32, 2048>) -> ParamStore<Flash<32, 2048>> {
    ParamStore::new(flash.clone(), flash.range())
}

/// Starts a vehicle as the firmware does, from `flash`.
fn start(flash: &Flash<32, 2048>) -> (Bench, Loaded) {
    let time = VirtualTime::new();
    let found = Rc::new(Cell::new(None));
    let (slot, mut storage) = (found.clone(), store(flash));
    time.spawn(async move { slot.set(Some(parameters::load(&mut storage).await)) });
    time.run_until(1);
    let (params, loaded) = found.take().unwrap();
    let bench = Bench::new(params).console(store(flash));
    parameters::report(bench.links, loaded);
    (bench, loaded)
}

#[test]
fn a_parameter_is_found_changed_saved_and_in_force_after_the_restart() {
    let flash = flash();
    let (bench, loaded) = start(&flash);
    assert_eq!(loaded, Loaded::default(), "blank");
    let mut bench = bench.commander(Mode::Disarmed, Mode::Disarmed);
    bench.run(100);
    let session = [
        "list infil\r",
        "get infill\r",
        "set infil 8\r",
        "set infill 12\r",
        "set infill eight\r",
        "set infill NaN\r",
        "set motor_protocol 200\r",
        "set infill 8\r",
        "set motor_protocol pwm\r",
        "set rate_pitch_p 11\r",
        "reset rate_pitch_p\r",
        "changes\r",
        "save\r",
    ]
    .map(|line| bench.types(line))
    .concat();
    println!("{session}");
    assert_eq!(session, include_str!("console/change.txt"));
    assert_eq!(bench.chip.restarts.get(), 1);

    let (mut bench, loaded) = start(&flash);
    assert_eq!((loaded.taken, loaded.refused, loaded.unreadable), (2, 0, false));
    let session = ["list infill\r", "changes\r", "defaults\r"]
        .map(|line| bench.types(line))
        .concat();
    println!("{session}");
    assert_eq!(session, include_str!("console/after.txt"));
}

#[test]
fn status_lists_every_reason_against_arming() {
    let mut bench = Bench::new(Params {
        servo_marks: ServoMarks::S1234,
        ..Params::default()
    });
    let links = bench.links;
    let analog = FakeAnalog::default();
    analog.frame.set(AnalogFrame {
        battery_voltage: 1520,
        ..AnalogFrame::default()
    });
    bench.time.spawn(imu::run(links, FakeImu::default()));
    bench.time.spawn(estimator::run(links));
    bench.time.spawn(analog::run(links, analog));
    bench.time.spawn(clamp::run(links));
    bench.time.spawn(servos::run(links, FakeServos::default()));
    bench.time.spawn(commander::run(links));
    let loaded = Loaded {
        unreadable: true,
        ..Loaded::default()
    };
    parameters::report(links, loaded);
    bench = bench.fake_storage(Ok(())).0;
    bench.run(5000);
    let session = ["help\r", "status\r", "set infill 8\r", "status\r"]
        .map(|line| bench.types(line))
        .concat();
    println!("{session}");
    assert_eq!(session, include_str!("console/status.txt"));

    let timing = bench.types("timing\r");
    println!("{timing}");
    for task in TaskId::ALL {
        let row = timing
            .lines()
            .find_map(|l| l.strip_prefix(task.name())?.strip_prefix(' '));
        let numbers: Vec<u32> = row
            .unwrap()
            .split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect();
        let [rate, late, response, execution, overruns] = numbers[..] else {
            panic!("{numbers:?}")
        };
        let t = links.timing.task(task);
        assert_eq!(
            (late, response, execution, overruns),
            (
                t.worst_lateness_us,
                t.worst_response_us,
                t.worst_execution_us,
                t.overruns
            )
        );
        let expected = match task {
            TaskId::Imu | TaskId::Estimator => 1000,
            TaskId::Analog => 500,
            TaskId::Clamp | TaskId::Commander => 100,
            TaskId::Servos => 50,
            _ => 0,
        };
        assert!(rate.abs_diff(expected) <= 1, "{} {rate}", task.name());
    }
}

fn saves_in(mode: Mode, then: Mode) -> (String, Bench, FakeStorage) {
    let (bench, storage) = Bench::new(Params::default()).fake_storage(Ok(()));
    let mut bench = bench.commander(mode, then);
    bench.run(100);
    let _ = bench.types("set infill 8\r");
    let answer = bench.types("save\r");
    (answer, bench, storage)
}

#[test]
fn nothing_is_stored_or_restarted_while_rotors_may_turn() {
    for mode in Mode::ALL {
        let stopped = matches!(mode, Mode::Disarmed | Mode::Calibrating);
        let (answer, mut bench, storage) = saves_in(mode, mode);
        assert_eq!(storage.saves.borrow().len(), usize::from(stopped), "{mode:?}");
        assert_eq!(bench.chip.restarts.get(), u32::from(stopped), "{mode:?}");
        assert_eq!(
            bench.links.hardware().contains(ArmingInhibit::Storing),
            stopped,
            "{mode:?}"
        );
        if !stopped {
            let name = mode.name();
            assert_eq!(answer, format!("save\nnot saved while {name}: disarm first\n> "));
            assert_eq!(
                bench.types("restart\r"),
                format!("restart\nnot restarted while {name}: disarm first\n> ")
            );
            assert_eq!(bench.chip.restarts.get(), 0, "{mode:?}");
        }
    }
    let (answer, bench, storage) = saves_in(Mode::Disarmed, Mode::Armed);
    assert_eq!(answer, "save\nnot saved while ARMED: disarm first\n> ");
    assert!(storage.saves.borrow().is_empty() && bench.chip.restarts.get() == 0);
    assert!(bench.links.hardware().is_empty());
}

#[test]
fn the_commander_refuses_arming_before_anything_is_stored() {
    let (_, bench, storage) = saves_in(Mode::Disarmed, Mode::Disarmed);
    let saves = storage.saves.borrow();
    let [(params, Some(status))] = saves.as_slice() else {
        panic!("{} saves", saves.len())
    };
    assert!(status.inhibits.contains(ArmingInhibit::Storing));
    assert!((params.infill, bench.links.params.infill) == (8.0, 6.9));
}

#[test]
fn without_a_commander_nothing_is_stored() {
    let (mut bench, storage) = Bench::new(Params::default()).fake_storage(Ok(()));
    bench.run(100);
    assert_eq!(
        bench.types("save\r"),
        "save\nnot saved: the commander is silent\n> "
    );
    bench.links.status.send(
        Instant::now(),
        Status {
            mode: Mode::Disarmed,
            ..Status::default()
        },
    );
    assert_eq!(
        bench.types("save\r"),
        "save\nnot saved: the commander is silent\n> "
    );
    assert!(storage.saves.borrow().is_empty() && bench.chip.restarts.get() == 0);
    assert!(bench.links.hardware().is_empty());
}

#[test]
fn a_storage_that_fails_is_named_and_the_changes_stay() {
    for (answer, hangs, inhibit, words) in [
        (
            StorageError::Full,
            false,
            ArmingInhibit::StorageFull,
            "the storage is full",
        ),
        (
            StorageError::Broken,
            false,
            ArmingInhibit::StorageUnreadable,
            "the storage does not keep what is written",
        ),
        (
            StorageError::Broken,
            true,
            ArmingInhibit::StorageUnreadable,
            "the storage does not keep what is written",
        ),
    ] {
        let bench = Bench::new(Params::default()).commander(Mode::Disarmed, Mode::Disarmed);
        let storage = FakeStorage {
            answer: Err(answer),
            saves: Rc::default(),
            links: bench.links,
            hangs,
        };
        let mut bench = bench.console(storage);
        bench.run(100);
        let _ = bench.types("set infill 8\r");
        bench.line.put(b"save\r");
        bench.run(12_000);
        assert_eq!(
            bench.screen.text.take(),
            format!("save\r\nnot saved: {words}; your changes are kept until a restart\r\n> ")
        );
        assert_eq!(bench.chip.restarts.get(), 0);
        assert!(bench.links.hardware().iter().eq([inhibit]));
        assert!(bench.types("changes\r").contains("infill 6.9 -> 8 %"));
    }
}

#[test]
fn a_failed_flash_is_reported_and_a_sound_one_allows_arming_again() {
    let flash = flash();
    let (bench, _) = start(&flash);
    let mut bench = bench.commander(Mode::Disarmed, Mode::Disarmed);
    bench.run(100);
    let _ = bench.types("set infill 8\r");
    flash.0.borrow_mut().dead = true;
    let answer = bench.types("save\r");
    assert!(
        answer.contains("the storage does not keep what is written"),
        "{answer}"
    );
    assert!(bench.links.hardware().contains(ArmingInhibit::StorageUnreadable));
    flash.0.borrow_mut().dead = false;
    assert_eq!(bench.types("save\r"), "save\nsaved; restarting\n> ");
    assert!(bench.links.hardware().iter().eq([ArmingInhibit::Storing]));
    assert_eq!(start(&flash).0.links.params.infill, 8.0);
}

#[test]
fn storage_with_another_programs_data_boots_with_defaults_and_a_message() {
    let bytes = (0..4096u32)
        .map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8)
        .collect();
    let flash = Flash::<32, 2048>::holding(bytes);
    let (bench, loaded) = start(&flash);
    assert!(loaded.unreadable && bench.links.params == Params::default());
    let mut bench = bench.commander(Mode::Disarmed, Mode::Disarmed);
    bench.run(100);
    assert!(
        bench
            .types("status\r")
            .contains("arming refused: stored parameters unreadable\n")
    );
    assert_eq!(bench.types("save\r"), "save\nsaved; restarting\n> ");
    let (bench, loaded) = start(&flash);
    assert!(!loaded.unreadable && bench.links.hardware().is_empty());
}

#[test]
fn a_noisy_line_does_nothing_and_starves_no_task() {
    let (bench, storage) = Bench::new(Params::default()).fake_storage(Ok(()));
    let mut bench = bench.commander(Mode::Disarmed, Mode::Disarmed);
    // A neighbour on the same level that only yields.
    let (turns, line) = (Rc::new(Cell::new(0u32)), bench.line.clone());
    let counter = turns.clone();
    bench.time.spawn(async move {
        let mut state = 1u32;
        for _ in 0..10_000 {
            // 12 bytes/ms: 115,200 baud without a pause.
            Timer::after_millis(1).await;
            let mut bytes = [0; 12];
            for byte in &mut bytes {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                *byte = (state >> 24) as u8;
            }
            line.put(&bytes);
            yield_now().await;
            counter.set(counter.get() + 1);
        }
    });
    bench.run(12_000);
    assert_eq!(turns.get(), 10_000);
    assert!(storage.saves.borrow().is_empty() && bench.chip.restarts.get() == 0);
    let _ = bench.types("\r");
    assert_eq!(bench.types("changes\r"), "changes\nno changes\n> ");
}

#[test]
fn a_burst_of_bytes_leaves_other_tasks_their_turn() {
    let (mut bench, _) = Bench::new(Params::default()).fake_storage(Ok(()));
    // 3,200 characters without line end or echo: 100 reads that are ready at once.
    bench.line.put(&[0x80; 3200]);
    let left = Rc::new(Cell::new(None));
    let (slot, line) = (left.clone(), bench.line.clone());
    bench.time.spawn(async move {
        yield_now().await;
        slot.set(Some(line.waiting()));
    });
    bench.run(10);
    assert!(left.get().is_some_and(|left| left > 3000), "{left:?} bytes left");
    assert_eq!(bench.line.waiting(), 0);
}

#[test]
fn a_broken_or_empty_line_costs_no_time() {
    for answer in [Answer::Fails, Answer::Refuses, Answer::Sound] {
        let part = Part::default();
        part.answer.set(answer);
        let mut bench = Bench::new(Params::default());
        let storage = store(&flash());
        let (links, screen) = (bench.links, bench.screen.clone());
        bench.time.spawn(console::run(
            links,
            BrokenLine(part.clone()),
            screen,
            storage,
            bench.chip.clone(),
        ));
        bench.run(1000);
        assert!(!part.spun.get(), "{answer:?}");
    }
}

#[test]
fn a_terminal_that_takes_nothing_loses_its_text_and_holds_nothing_up() {
    let (bench, storage) = Bench::new(Params::default()).fake_storage(Ok(()));
    let mut bench = bench.commander(Mode::Disarmed, Mode::Disarmed);
    bench.run(100);
    bench.screen.hangs.set(true);
    // 90 lines, each waiting for the terminal.
    bench.line.put(b"list\r");
    bench.run(700);
    bench.line.put(b"set infill 8\rsave\r");
    bench.run(2000);
    assert_eq!(storage.saves.borrow().len(), 1);
    assert!(storage.saves.borrow()[0].0.infill == 8.0);
    bench.screen.hangs.set(false);
    assert!(
        bench
            .types("changes\r")
            .ends_with("1 change, in force after save\n> ")
    );
}

#[test]
fn the_whole_list_fits_its_lines_and_misspelt_commands_are_helped() {
    let (mut bench, _) = Bench::new(Params::default()).fake_storage(Ok(()));
    bench.run(10);
    bench.line.put(b"list\r");
    bench.run(3000);
    let text = bench.screen.text.take();
    let rows: Vec<&str> = text.lines().skip(1).take_while(|l| *l != "> ").collect();
    assert_eq!(rows.len(), Params::TABLE.len());
    for (row, info) in rows.iter().zip(Params::TABLE) {
        let words: Vec<&str> = row.split_whitespace().collect();
        assert_eq!(words[..2], [info.name, &info.default.to_string()], "{row}");
        assert!(row.len() <= 80, "{row}");
    }
    for (typed, answer) in [
        ("statsu", "no command 'statsu'; did you mean 'status'?"),
        ("arm", "no command 'arm'; try 'help'"),
        ("get", "say 'get NAME'"),
        ("list nothing", "no parameter has 'nothing' in its name"),
        ("get qqqqq", "no parameter 'qqqqq'; 'list' shows them all"),
        ("s\u{e4}ve", "only printable ASCII characters are understood"),
        (
            "set infill 7\0.5",
            "only printable ASCII characters are understood",
        ),
        ("set infill 1\t0", "say 'set NAME VALUE'"),
    ] {
        let screen = bench.types(&format!("{typed}\r"));
        assert_eq!(screen.lines().nth(1), Some(answer));
    }
    let long = format!("save {}\r", "x".repeat(200));
    let screen = bench.types(&long);
    assert_eq!(
        screen.lines().nth(1),
        Some("line too long: 80 characters at most")
    );
}

#[test]
fn the_start_up_checks_print_as_a_table() {
    let mut bench = Bench::new(Params::default());
    bench.chip = FakeChip {
        stack: Some(StackUse {
            bytes: 65_536,
            start: 21_076,
            flight: 49_160,
        }),
        ..chip_at(0)
    };
    let mut bench = bench.fake_storage(Ok(())).0;
    assert_eq!(
        bench.types("silicon\r"),
        "silicon\n  flash wait states    5                            expected: 5\n\
         * brown-out level      0                            expected: 3\n  \
         stack at start-up    21076 of 65536 bytes         expected: a quarter left\n\
         * stack since          49160 of 65536 bytes         expected: a quarter left\n> "
    );
}

#[test]
fn the_brown_out_level_is_set_after_an_explanation_and_a_confirmation() {
    let mut bench = Bench::new(Params::default()).commander(Mode::Disarmed, Mode::Disarmed);
    bench.chip = chip_at(0);
    let mut bench = bench.fake_storage(Ok(())).0;
    bench.run(100);
    let said = bench.types("brownout\r");
    for words in [
        "level 0, expected 3",
        "'brownout set' writes",
        "below about 2.7 V",
        "restarts",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(said.lines().all(|line| line.len() <= 100), "{said}");
    assert_eq!((bench.chip.level.get(), bench.chip.restarts.get()), (0, 0));
    assert_eq!(bench.types("brownout set\r"), "brownout set\nset; restarting\n> ");
    assert_eq!((bench.chip.level.get(), bench.chip.restarts.get()), (3, 1));
    assert!(bench.links.hardware().iter().eq([ArmingInhibit::Storing]));
}

#[test]
fn a_level_that_is_set_is_left_alone() {
    let mut bench = Bench::new(Params::default()).commander(Mode::Disarmed, Mode::Disarmed);
    bench.chip = chip_at(3);
    let mut bench = bench.fake_storage(Ok(())).0;
    bench.run(100);
    assert_eq!(
        bench.types("brownout\r"),
        "brownout\nbrown-out level 3, expected 3\nnothing to do\n> "
    );
    assert_eq!(
        bench.types("brownout set\r"),
        "brownout set\nnot set: nothing to do\n> "
    );
    assert_eq!(bench.chip.restarts.get(), 0);
}

#[test]
fn the_brown_out_level_is_not_set_while_rotors_may_turn_nor_where_the_chip_refuses() {
    for (mode, then) in [(Mode::Armed, Mode::Armed), (Mode::Disarmed, Mode::Armed)] {
        let mut bench = Bench::new(Params::default()).commander(mode, then);
        bench.chip = chip_at(0);
        let mut bench = bench.fake_storage(Ok(())).0;
        bench.run(100);
        assert_eq!(
            bench.types("brownout set\r"),
            "brownout set\nnot set while ARMED: disarm first\n> "
        );
        assert_eq!((bench.chip.level.get(), bench.chip.restarts.get()), (0, 0));
        assert!(bench.links.hardware().is_empty());
    }
    let mut bench = Bench::new(Params::default()).commander(Mode::Disarmed, Mode::Disarmed);
    bench.chip = FakeChip {
        refuses: true,
        ..chip_at(0)
    };
    let mut bench = bench.fake_storage(Ok(())).0;
    bench.run(100);
    assert_eq!(
        bench.types("brownout set\r"),
        "brownout set\nnot set: the chip's option bytes did not take it\n> "
    );
    assert_eq!(bench.chip.restarts.get(), 0);
    assert!(bench.links.hardware().is_empty());
}
