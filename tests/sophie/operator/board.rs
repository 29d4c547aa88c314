//! A board on a table, served over TCP, a serial port or MAVLink: the console task and the tasks that it asks, on scripted parts. Its time runs
//! faster than the clock on the wall, its stored parameters outlive its restarts.

use std::cell::{Cell, RefCell};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sophie_clock::VirtualTime;
use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::motor_map::at_rotors;
use sophie_control::allocation::wrench::{Configuration, PerArm};
use sophie_control::arming::ArmingInhibit;
use sophie_control::chain::ImuReading;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::{MotorMap, Params};
use sophie_control::pilot::rc::Sticks;
use sophie_fakes::{FakeAnalog, FakeBarometer, FakeImu, FakeLine, FakeMotors, FakeServos};
use sophie_ports::chip::{Chip, NotSet};
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::error::PortError;
use sophie_ports::receiver::RcState;
use sophie_ports::sensors::{AnalogFrame, ArmImus};
use sophie_ports::serial::SerialOutput;
use sophie_ports::signing::{Key, Record, Stored};
use sophie_ports::storage::{Loaded, Storage, StorageError};
use sophie_tasks::console;
use sophie_tasks::flight::{control, estimator, imu, mixer, motors};
use sophie_tasks::ground_station::console_pipe::{ConsolePipe, ConsolePipePort};
use sophie_tasks::ground_station::mavlink::{self, Lines};
use sophie_tasks::links::Links;
use sophie_tasks::navigation::barometer;
use sophie_tasks::perching::{analog, arms, clamp, servos};
use sophie_tasks::pilot::commander;

use super::wire::Wire;

/// The board's time in one round, ms, and the time on the wall that a round takes at least: twenty times real time.
const ROUND_MS: u64 = 10;
const ROUND: Duration = Duration::from_micros(500);
/// Time on the wall that the board is away after a restart.
const AWAY: Duration = Duration::from_millis(300);

/// Time on the wall after which what a test waits for does not come, whatever the load of the machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// What hands do to the board, and what goes wrong with its line.
#[derive(Clone)]
pub struct Hands {
    /// What the inertial sensor reads, m/s2.
    pub force: Vec3,
    /// Counts of the pressure sensors and of the battery's voltage, 0.01 V each.
    pub counts: AnalogFrame,
    /// Tilt of each arm's tip, rad.
    pub tilt: PerArm<f32>,
    /// What the barometer reads, Pa; `None`: nothing.
    pub air: Option<f32>,
    /// What the receiver gives at 50 Hz; `None`: nothing.
    pub sticks: Option<Sticks>,
    /// The board takes what is typed and says nothing.
    pub mute: bool,
    /// It falls silent for good with the first answer that has this text.
    pub dies_at: Option<&'static str>,
    /// Every so many bytes one that is typed is lost.
    pub loses: Option<usize>,
    /// Every so many frames of MAVLink one that is said is lost.
    pub drops: Option<usize>,
    /// The storage keeps nothing.
    pub broken: bool,
    /// The start could not read the storage; what is stored next repairs it.
    pub unreadable: bool,
    /// The storage takes a set and keeps the old one.
    pub forgets: bool,
    /// The chip has its brown-out level.
    pub brown_out_set: bool,
    /// The plug is pulled with the first answer that has this text.
    pub unplugged_at: Option<&'static str>,
    /// Which board it says it is.
    pub board: &'static str,
    /// Which image it is said to be.
    pub build: u32,
    /// How the motors are wired.
    pub wiring: MotorMap,
    /// Its time is that of the wall.
    pub real_time: bool,
    /// It is powered off and on.
    pub power_cycle: bool,
}

/// What the board's pins do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// What each rotor gets, as the motors are wired.
    pub motors: PerArm<f64>,
    /// Last servo pulses, us.
    pub servos: PerArm<f32>,
}

impl Default for Hands {
    fn default() -> Self {
        Self {
            force: Vec3::new(0.0, 0.0, -GRAVITY),
            counts: AnalogFrame {
                fsr: [0; 4],
                battery_voltage: 1520,
                battery_current: 0,
                servo_battery: 0,
            },
            tilt: [0.0; 4],
            air: None,
            sticks: None,
            mute: false,
            dies_at: None,
            loses: None,
            drops: None,
            broken: false,
            unreadable: false,
            forgets: false,
            brown_out_set: true,
            unplugged_at: None,
            board: "table",
            build: 0x1234_ABCD,
            wiring: MotorMap::STRAIGHT,
            real_time: false,
            power_cycle: false,
        }
    }
}

/// The board and its thread, which ends with it.
pub struct Board {
    /// Name of its console, as `--port` takes it.
    name: String,
    hands: Arc<Mutex<Hands>>,
    stored: Arc<Mutex<Params>>,
    outputs: Arc<Mutex<Outputs>>,
    /// The board's time over all its starts, ms.
    ms: Arc<AtomicU64>,
    /// Changes of parameters that it has reported.
    changes: Arc<AtomicU64>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Board {
    /// Powers a board up.
    pub fn new(hands: Hands) -> Self {
        Self::on(Wire::socket(), hands, Protocol::Console)
    }

    /// The same with its console on a serial port.
    #[cfg(target_os = "linux")]
    pub fn on_serial(hands: Hands) -> Self {
        Self::on(Wire::serial(), hands, Protocol::Console)
    }

    /// The same with its console over MAVLink, signed by `key` where there is one.
    pub fn on_mavlink(hands: Hands, key: Option<Key>) -> Self {
        let (wire, name) = Wire::socket();
        Self::on((wire, format!("mavlink:{name}")), hands, Protocol::Mavlink(key))
    }

    /// MAVLink on a serial port.
    #[cfg(target_os = "linux")]
    pub fn on_serial_mavlink(hands: Hands) -> Self {
        Self::on(Wire::serial(), hands, Protocol::Mavlink(None))
    }

    /// Over MAVLink, with the parameters that it has stored.
    pub fn with_stored(hands: Hands, stored: Params) -> Self {
        let (wire, name) = Wire::socket();
        let wire = (wire, format!("mavlink:{name}"));
        Self::starting(wire, hands, Protocol::Mavlink(None), stored)
    }

    fn on(wire: (Wire, String), hands: Hands, protocol: Protocol) -> Self {
        Self::starting(wire, hands, protocol, Params::DEFAULT)
    }

    fn starting((mut wire, name): (Wire, String), hands: Hands, protocol: Protocol, stored: Params) -> Self {
        let hands = Arc::new(Mutex::new(hands));
        let stored = Arc::new(Mutex::new(stored));
        let signing = match protocol {
            Protocol::Mavlink(Some(key)) => Stored::Key(Record::fresh(key)),
            _ => Stored::None,
        };
        let signing = Arc::new(Mutex::new(signing));
        let stop = Arc::new(AtomicBool::new(false));
        let ms = Arc::<AtomicU64>::default();
        let outputs = Arc::<Mutex<Outputs>>::default();
        let changes = Arc::<AtomicU64>::default();
        let seen = Seen {
            outputs: outputs.clone(),
            ms: ms.clone(),
            changes: changes.clone(),
        };
        let shared = (hands.clone(), stored.clone(), stop.clone());
        let thread = std::thread::spawn(move || {
            let (hands, stored, stop) = shared;
            while !stop.load(Ordering::Relaxed) {
                let params = *stored.lock().unwrap();
                Run::start(&hands, &stored, &signing, params, protocol).serve(&mut wire, &seen, &stop);
            }
        });
        Self {
            name,
            hands,
            stored,
            outputs,
            ms,
            changes,
            stop,
            thread: Some(thread),
        }
    }

    /// Name of its console, as `--port` takes it.
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// A user of its own at the socket.
    fn connects(&self) -> TcpStream {
        TcpStream::connect(self.name.strip_prefix("tcp:").unwrap()).unwrap()
    }

    /// What its pins do now.
    pub fn outputs(&self) -> Outputs {
        *self.outputs.lock().unwrap()
    }

    /// The board's time over all its starts.
    pub fn seconds(&self) -> f64 {
        self.ms.load(Ordering::Relaxed) as f64 * 1e-3
    }

    /// Waits until a parameter has been set.
    pub fn hears_a_change(&self) {
        let begun = Instant::now();
        while self.changes.load(Ordering::Relaxed) == 0 {
            assert!(begun.elapsed() < PATIENCE, "nothing is set");
            std::thread::sleep(ROUND);
        }
    }

    /// What is said in `seconds` of the board's time without a word of anybody.
    pub fn says_by_itself(&self, seconds: f64) -> String {
        let mut user = self.connects();
        self.pass(seconds);
        user.set_nonblocking(true).unwrap();
        let mut said = [0; 1024];
        let count = user.read(&mut said).unwrap_or(0);
        String::from_utf8_lossy(&said[..count]).into_owned()
    }

    /// Changes what hands do.
    pub fn hands(&self, change: impl FnOnce(&mut Hands)) {
        change(&mut self.hands.lock().unwrap());
    }

    /// Waits while `seconds` of the board's time pass.
    pub fn pass(&self, seconds: f64) {
        let until = self.ms.load(Ordering::Relaxed) + (seconds * 1e3) as u64;
        let begun = Instant::now();
        while self.ms.load(Ordering::Relaxed) < until {
            assert!(begun.elapsed() < PATIENCE, "the board stands still");
            std::thread::sleep(ROUND);
        }
    }

    /// What is stored.
    pub fn stored(&self) -> Params {
        *self.stored.lock().unwrap()
    }

    /// Types `bytes` over a connection of its own, which is gone afterwards.
    pub fn type_and_leave(&self, bytes: &[u8]) {
        let mut user = self.connects();
        user.write_all(bytes).unwrap();
        user.set_read_timeout(Some(PATIENCE)).unwrap();
        // Until it has been echoed, so that it is there; a cursor key has no echo.
        let echoed = bytes.split(|byte| *byte == 0x1B).next().unwrap_or_default();
        let printable = echoed.iter().filter(|byte| (b' '..=b'~').contains(byte)).count();
        let (mut echo, mut heard) = ([0; 64], 0);
        while heard < printable {
            heard += user.read(&mut echo).unwrap();
        }
    }

    /// Asks for the status until it has `text`.
    pub fn until(&self, text: &str) {
        let mut user = self.connects();
        user.set_read_timeout(Some(PATIENCE)).unwrap();
        let begun = Instant::now();
        let mut said = String::new();
        while !said.contains(text) {
            assert!(begun.elapsed() < PATIENCE, "{said}");
            said.clear();
            user.write_all(b"status\r").unwrap();
            while !said.ends_with("\n> ") {
                let mut bytes = [0; 64];
                let count = user.read(&mut bytes).unwrap();
                said.push_str(&String::from_utf8_lossy(&bytes[..count]));
            }
        }
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// What is seen of the board from outside.
struct Seen {
    outputs: Arc<Mutex<Outputs>>,
    ms: Arc<AtomicU64>,
    changes: Arc<AtomicU64>,
}

/// What the wire carries.
#[derive(Clone, Copy)]
enum Protocol {
    Console,
    Mavlink(Option<Key>),
}

/// One start of the board.
struct Run {
    time: VirtualTime,
    links: &'static Links,
    hands: Arc<Mutex<Hands>>,
    line: FakeLine,
    screen: Screen,
    frames: Option<Frames>,
    imu: FakeImu,
    analog: FakeAnalog,
    barometer: FakeBarometer,
    arms: Arms,
    motors: FakeMotors,
    servos: FakeServos,
    chip: ThisChip,
}

impl Run {
    fn start(
        hands: &Arc<Mutex<Hands>>,
        stored: &Arc<Mutex<Params>>,
        signing: &Arc<Mutex<Stored>>,
        params: Params,
        protocol: Protocol,
    ) -> Self {
        let now = hands.lock().unwrap().clone();
        let links: &'static Links = Box::leak(Box::new(Links::new(params)));
        let restarted = Rc::<Cell<bool>>::default();
        let screen = Screen {
            text: Rc::default(),
            restarted: restarted.clone(),
        };
        let run = Self {
            time: VirtualTime::new(),
            links,
            hands: hands.clone(),
            line: FakeLine::default(),
            screen,
            frames: match protocol {
                Protocol::Console => None,
                Protocol::Mavlink(_) => Some(Frames::default()),
            },
            imu: FakeImu::default(),
            analog: FakeAnalog::default(),
            barometer: FakeBarometer::default(),
            arms: Arms::default(),
            motors: FakeMotors::default(),
            servos: FakeServos::default(),
            chip: ThisChip {
                hands: hands.clone(),
                stored: stored.clone(),
                signing: signing.clone(),
                checks: checks(now.brown_out_set),
                restarted,
            },
        };
        links.report(ArmingInhibit::BrownOutLevel, !now.brown_out_set);
        links.report(ArmingInhibit::StorageUnreadable, now.unreadable);
        run.spawn(protocol);
        run
    }

    fn spawn(&self, protocol: Protocol) {
        let (time, links) = (&self.time, self.links);
        time.spawn(imu::run(links, self.imu.clone()));
        time.spawn(estimator::run(links));
        time.spawn(control::run(links));
        time.spawn(mixer::run(links, |p| Flexible::new(Configuration::B, p)));
        time.spawn(motors::run(links, self.motors.clone()));
        time.spawn(analog::run(links, self.analog.clone()));
        time.spawn(arms::run(links, self.arms.clone()));
        time.spawn(barometer::run(links, self.barometer.clone()));
        time.spawn(clamp::run(links));
        time.spawn(servos::run(links, self.servos.clone()));
        time.spawn(commander::run(links));
        let (line, screen, chip) = (self.line.clone(), self.screen.clone(), self.chip.clone());
        let (Protocol::Mavlink(_), Some(frames)) = (protocol, &self.frames) else {
            return time.spawn(console::run(links, line, screen, chip.clone(), chip));
        };
        let shell: &'static ConsolePipe = Box::leak(Box::default());
        let lines = Lines {
            inputs: [line],
            outputs: [frames.clone()],
            bytes_per_second: [5000],
        };
        let signing = *chip.signing.lock().unwrap();
        let storage = chip.clone();
        time.spawn(mavlink::run(links, lines, shell, storage, chip.clone(), signing));
        let tapped = Tapped(shell.port(), screen);
        time.spawn(console::run(links, shell.port(), tapped, chip.clone(), chip));
    }

    /// Runs until the board restarts or `stop` is set.
    fn serve(self, wire: &mut Wire, seen: &Seen, stop: &AtomicBool) {
        let mut ms = 0;
        while !stop.load(Ordering::Relaxed) {
            let begun = Instant::now();
            let hands = self.hands.lock().unwrap().clone();
            if hands.power_cycle {
                self.hands.lock().unwrap().power_cycle = false;
                break;
            }
            self.apply(&hands, ms);
            ms += ROUND_MS;
            seen.ms.fetch_add(ROUND_MS, Ordering::Relaxed);
            self.time.run_until(ms * 1000);
            *seen.outputs.lock().unwrap() = self.outputs(&hands);
            let mut said = self.screen.text.take();
            let has =
                |text: Option<&str>| text.is_some_and(|text| String::from_utf8_lossy(&said).contains(text));
            if has(Some(", in force after save")) {
                seen.changes.fetch_add(1, Ordering::Relaxed);
            }
            let dies = has(hands.dies_at);
            let unplugged = has(hands.unplugged_at);
            if let Some(frames) = &self.frames {
                said = frames.take(hands.drops);
            }
            if unplugged {
                wire.unplug();
            }
            if dies {
                self.hands.lock().unwrap().mute = true;
            }
            if dies || hands.mute {
                said.clear();
            }
            let typed = wire.exchange(&said, hands.loses);
            self.line.put(&typed);
            if self.chip.restarted.get() {
                break;
            }
            let round = if hands.real_time {
                Duration::from_millis(ROUND_MS)
            } else {
                ROUND
            };
            std::thread::sleep(round.saturating_sub(begun.elapsed()));
        }
        if self.chip.restarted.get() {
            // What is typed meanwhile is lost; the pins' noise is not.
            let begun = Instant::now();
            while begun.elapsed() < AWAY && !stop.load(Ordering::Relaxed) {
                wire.exchange(b"", None);
                std::thread::sleep(ROUND);
            }
            wire.exchange(b"\x00\xff\xfe> \x00", None);
        }
    }

    fn outputs(&self, hands: &Hands) -> Outputs {
        let commands = self.motors.commands.get().map(f64::from);
        Outputs {
            motors: at_rotors(&hands.wiring.rotors(), &commands),
            servos: self.servos.pulses.borrow().last().copied().unwrap_or_default(),
        }
    }

    fn apply(&self, hands: &Hands, ms: u64) {
        self.imu.2.set(ImuReading {
            gyro: Vec3::ZERO,
            accel: hands.force + Vec3::new(0.0, 0.0, GRAVITY),
        });
        self.analog.frame.set(hands.counts);
        self.arms.0.set(hands.tilt);
        // No number is no pressure.
        self.barometer.1.set(hands.air.unwrap_or(f32::NAN));
        if let (Some(sticks), 0) = (hands.sticks, ms % 20) {
            let state = RcState {
                sticks,
                frames: (ms / 20) as u32,
                errors: 0,
            };
            self.links.rc.send(embassy_time::Instant::now(), state);
        }
    }
}

fn checks(brown_out_set: bool) -> [ChipCheck; 2] {
    [
        ChipCheck {
            name: "revision",
            read: heapless::String::try_from("0x450 0x2003").unwrap(),
            expected: "0x2001 (X) or later",
            ok: true,
            inhibits: None,
        },
        ChipCheck {
            name: "brown-out level",
            read: heapless::String::try_from(if brown_out_set { "3" } else { "0" }).unwrap(),
            expected: "3",
            ok: brown_out_set,
            inhibits: Some(ArmingInhibit::BrownOutLevel),
        },
    ]
}

/// Arm sensors on a level body.
#[derive(Clone, Default)]
struct Arms(Rc<Cell<PerArm<f32>>>);

impl ArmImus for Arms {
    async fn gravity(&mut self, arm: usize) -> Result<Vec3, PortError> {
        embassy_time::Timer::after_micros(400).await;
        // A right arm's tip that goes up turns the other way round.
        let side = if arm < 2 { 1.0 } else { -1.0 };
        let tilt = side * self.0.get()[arm];
        Ok(Vec3::new(0.0, GRAVITY * tilt.sin(), GRAVITY * tilt.cos()))
    }
}

/// What is said until the board restarts.
#[derive(Clone)]
struct Screen {
    text: Rc<RefCell<Vec<u8>>>,
    restarted: Rc<Cell<bool>>,
}

impl SerialOutput for Screen {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        if !self.restarted.get() {
            self.text.borrow_mut().extend_from_slice(bytes);
        }
        Ok(())
    }
}

/// The console over MAVLink, whose words are on the screen as well.
struct Tapped(ConsolePipePort<'static>, Screen);

impl SerialOutput for Tapped {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        self.1.write(bytes).await?;
        self.0.write(bytes).await
    }
}

/// Frames that are said, each in one write.
#[derive(Clone, Default)]
struct Frames {
    said: Rc<RefCell<Vec<Vec<u8>>>>,
    count: Rc<Cell<usize>>,
}

impl Frames {
    /// What has been said, less each `drops`th frame.
    fn take(&self, drops: Option<usize>) -> Vec<u8> {
        let mut kept = Vec::new();
        for frame in self.said.take() {
            self.count.set(self.count.get() + 1);
            if drops.is_none_or(|every| !self.count.get().is_multiple_of(every)) {
                kept.extend(frame);
            }
        }
        kept
    }
}

impl SerialOutput for Frames {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        self.said.borrow_mut().push(bytes.to_vec());
        Ok(())
    }
}

#[derive(Clone)]
struct ThisChip {
    hands: Arc<Mutex<Hands>>,
    stored: Arc<Mutex<Params>>,
    signing: Arc<Mutex<Stored>>,
    checks: [ChipCheck; 2],
    restarted: Rc<Cell<bool>>,
}

impl Storage for ThisChip {
    fn defaults(&self) -> &'static Params {
        &Params::DEFAULT
    }

    async fn load(&mut self, _params: &mut Params) -> Loaded {
        Loaded::default()
    }

    async fn save(&mut self, params: &Params) -> Result<(), StorageError> {
        let mut hands = self.hands.lock().unwrap();
        if hands.broken {
            return Err(StorageError::Broken);
        }
        hands.unreadable = false;
        if !hands.forgets {
            *self.stored.lock().unwrap() = *params;
        }
        Ok(())
    }

    async fn save_signing(&mut self, record: Option<Record>) -> Result<(), StorageError> {
        if self.hands.lock().unwrap().broken {
            return Err(StorageError::Broken);
        }
        *self.signing.lock().unwrap() = record.map_or(Stored::None, Stored::Key);
        Ok(())
    }
}

impl Chip for ThisChip {
    fn restart(&mut self) {
        self.restarted.set(true);
    }

    fn enter_loader(&mut self) {}

    fn board(&self) -> &'static str {
        self.hands.lock().unwrap().board
    }

    fn build(&self) -> u32 {
        self.hands.lock().unwrap().build
    }

    fn checks(&self) -> &[ChipCheck] {
        &self.checks
    }

    fn brown_out_volts(&self) -> f32 {
        2.6
    }

    async fn set_brown_out(&mut self) -> Result<(), NotSet> {
        self.hands.lock().unwrap().brown_out_set = true;
        Ok(())
    }
}
