//! The console, session by session: what is typed and what is answered.

mod fakes;
#[allow(dead_code, reason = "the drivers' tests use the rest")]
#[path = "../../drivers/tests/fake/flash.rs"]
mod flash;

use std::cell::{Cell, RefCell};
use std::rc::Rc;

use embassy_futures::yield_now;
use embassy_time::{Instant, Timer};
use fakes::{Answer, BrokenLine, FakeAnalog, FakeImu, FakeLine, Part};
use flash::Flash;
use sophie_control::arming::Refusal;
use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_drivers::param_store::ParamStore;
use sophie_hil::clock::VirtualTime;
use sophie_tasks::links::{Links, Status};
use sophie_tasks::ports::{AnalogFrame, Loaded, PortError, Restart, SerialOutput, Storage, StorageError};
use sophie_tasks::{analog, commander, console, estimator, imu, parameters};

/// A terminal's screen at 115,200 baud, or one that takes nothing.
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

/// A restart that is counted.
#[derive(Clone, Default)]
struct Restarts(Rc<Cell<u32>>);

impl Restart for Restarts {
    fn restart(&mut self) {
        self.0.set(self.0.get() + 1);
    }
}

/// A storage that answers as it is told, with the commander's view at the moment of the save.
#[derive(Clone)]
struct FakeStorage {
    answer: Result<(), StorageError>,
    saves: Rc<RefCell<Vec<(Params, Option<Status>)>>>,
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
}

/// A vehicle on the bench with a console.
struct Bench {
    time: VirtualTime,
    links: &'static Links,
    line: FakeLine,
    screen: Screen,
    restarts: Restarts,
    ms: u64,
}

impl Bench {
    fn new(params: Params) -> Self {
        Self {
            time: VirtualTime::new(),
            links: Box::leak(Box::new(Links::new(params))),
            line: FakeLine::default(),
            screen: Screen::default(),
            restarts: Restarts::default(),
            ms: 0,
        }
    }

    /// With the console over `storage`.
    fn console(self, storage: impl Storage + 'static) -> Self {
        let (links, line, screen) = (self.links, self.line.clone(), self.screen.clone());
        self.time
            .spawn(console::run(links, line, screen, storage, self.restarts.clone()));
        self
    }

    /// With a commander that is in `mode`, and in `then` as soon as it hears of the saving.
    fn commander(self, mode: Mode, then: Mode) -> Self {
        let links = self.links;
        self.time.spawn(async move {
            loop {
                let refusals = links.hardware();
                let storing = refusals.contains(Refusal::Storing);
                let status = Status {
                    mode: if storing { then } else { mode },
                    reason: refusals.first().map_or("", Refusal::text),
                    refusals,
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

    /// Types `text`, waits until it is answered, and gives what has appeared on the screen since.
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

/// Starts a vehicle on the bench, as the firmware does, with what `flash` holds.
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
        "set motor_protocol 400\r",
        "set rate_p 11\r",
        "reset rate_p\r",
        "changes\r",
        "save\r",
    ]
    .map(|line| bench.types(line))
    .concat();
    println!("{session}");
    assert_eq!(session, include_str!("console/change.txt"));
    assert_eq!(bench.restarts.0.get(), 1);

    let (mut bench, loaded) = start(&flash);
    assert_eq!(
        (loaded.taken, loaded.refused, loaded.unreadable),
        (2, 0, false)
    );
    let session = ["list infill\r", "changes\r", "defaults\r"]
        .map(|line| bench.types(line))
        .concat();
    println!("{session}");
    assert_eq!(session, include_str!("console/after.txt"));
}

#[test]
fn status_says_all_that_forbids_arming() {
    let mut bench = Bench::new(Params::default());
    let links = bench.links;
    let analog = FakeAnalog::default();
    // A battery of 15.2 V, pressure sensors without load.
    analog.frame.set(AnalogFrame {
        battery_voltage: 1520,
        ..AnalogFrame::default()
    });
    bench.time.spawn(imu::run(links, FakeImu::default()));
    bench.time.spawn(estimator::run(links));
    bench.time.spawn(analog::run(links, analog));
    bench.time.spawn(commander::run(links));
    let loaded = Loaded {
        unreadable: true,
        ..Loaded::default()
    };
    parameters::report(links, loaded);
    bench = bench.fake_storage(Ok(())).0;
    bench.run(5000);
    let session = ["help\r", "status\r", "set infill 8\r", "status\r", "timing\r"]
        .map(|line| bench.types(line))
        .concat();
    println!("{session}");
    assert_eq!(session, include_str!("console/status.txt"));
}
