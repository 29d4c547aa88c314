//! A board on a table, served over TCP: the console task and the tasks that it asks, on scripted parts. Its time runs
//! faster than the clock on the wall, its stored parameters outlive its restarts.

use std::cell::{Cell, RefCell};
use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::rc::Rc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use sophie_clock::VirtualTime;
use sophie_control::arming::ArmingInhibit;
use sophie_control::math::GRAVITY;
use sophie_control::mixer::Flexible;
use sophie_control::params::Params;
use sophie_control::rc::Sticks;
use sophie_control::vector::Vec3;
use sophie_control::wrench::{Configuration, PerArm};
use sophie_fakes::{FakeAnalog, FakeImu, FakeLine, FakeMotors, FakeServos};
use sophie_tasks::links::{Links, RcState};
use sophie_tasks::mavlink::signing::Record;
use sophie_tasks::ports::{
    AnalogFrame, ArmImus, Chip, ImuReading, Loaded, Look, NotSet, PortError, SerialOutput, Storage,
    StorageError,
};
use sophie_tasks::{analog, arms, clamp, commander, console, control, estimator, imu, mixer, motors, servos};

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
    /// What the receiver gives at 50 Hz; `None`: nothing.
    pub sticks: Option<Sticks>,
    /// The board takes what is typed and says nothing.
    pub mute: bool,
    /// It falls silent for good with the first answer that has this text.
    pub dies_at: Option<&'static str>,
    /// Every so many bytes one that is typed is lost.
    pub loses: Option<usize>,
    /// The storage keeps nothing.
    pub broken: bool,
    /// The storage takes a set and keeps the old one.
    pub forgets: bool,
    /// The chip has its brown-out level.
    pub brown_out_set: bool,
}

impl Default for Hands {
    fn default() -> Self {
        Self {
            force: Vec3::new(0.0, 0.0, -GRAVITY),
            counts: AnalogFrame {
                fsr: [0; 4],
                battery_voltage: 1520,
                battery_current: 0,
            },
            tilt: [0.0; 4],
            sticks: None,
            mute: false,
            dies_at: None,
            loses: None,
            broken: false,
            forgets: false,
            brown_out_set: true,
        }
    }
}

/// The board and its thread, which ends with it.
pub struct Board {
    /// Port of its console on the loopback interface.
    pub port: u16,
    hands: Arc<Mutex<Hands>>,
    stored: Arc<Mutex<Params>>,
    /// The board's time over all its starts, ms.
    ms: Arc<AtomicU64>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Board {
    /// Powers a board up.
    pub fn new(hands: Hands) -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        listener.set_nonblocking(true).unwrap();
        let port = listener.local_addr().unwrap().port();
        let hands = Arc::new(Mutex::new(hands));
        let stored = Arc::new(Mutex::new(Params::DEFAULT));
        let stop = Arc::new(AtomicBool::new(false));
        let ms = Arc::<AtomicU64>::default();
        let shared = (hands.clone(), stored.clone(), stop.clone(), ms.clone());
        let thread = std::thread::spawn(move || {
            let (hands, stored, stop, ms) = shared;
            let mut wire = Wire::new(listener);
            while !stop.load(Ordering::Relaxed) {
                let params = *stored.lock().unwrap();
                Run::start(&hands, &stored, params).serve(&mut wire, &stop, &ms);
            }
        });
        Self {
            port,
            hands,
            stored,
            ms,
            stop,
            thread: Some(thread),
        }
    }

    /// Name of its console, as `--port` takes it.
    pub fn name(&self) -> String {
        format!("tcp:127.0.0.1:{}", self.port)
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
        let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
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
        let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).unwrap();
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

/// The console's socket, one user at a time, the latest.
struct Wire {
    listener: TcpListener,
    user: Option<TcpStream>,
    /// Bytes that were typed so far.
    typed: usize,
}

impl Wire {
    fn new(listener: TcpListener) -> Self {
        Self {
            listener,
            user: None,
            typed: 0,
        }
    }

    /// Sends `said`; what was typed, less what the line loses.
    fn exchange(&mut self, said: &[u8], loses: Option<usize>) -> Vec<u8> {
        if let Ok((user, _)) = self.listener.accept() {
            user.set_nonblocking(true).unwrap();
            self.user = Some(user);
        }
        let Some(user) = &mut self.user else {
            return Vec::new();
        };
        let mut bytes = [0; 256];
        let count = match user.read(&mut bytes) {
            Ok(0) => None,
            Ok(count) => Some(count),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Some(0),
            Err(_) => None,
        };
        if count.is_none() || user.write_all(said).is_err() {
            self.user = None;
        }
        let mut typed = Vec::new();
        for byte in &bytes[..count.unwrap_or(0)] {
            self.typed += 1;
            if loses.is_none_or(|every| !self.typed.is_multiple_of(every)) {
                typed.push(*byte);
            }
        }
        typed
    }
}

/// One start of the board.
struct Run {
    time: VirtualTime,
    links: &'static Links,
    hands: Arc<Mutex<Hands>>,
    line: FakeLine,
    screen: Screen,
    imu: FakeImu,
    analog: FakeAnalog,
    arms: Arms,
    chip: ThisChip,
}

impl Run {
    fn start(hands: &Arc<Mutex<Hands>>, stored: &Arc<Mutex<Params>>, params: Params) -> Self {
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
            imu: FakeImu::default(),
            analog: FakeAnalog::default(),
            arms: Arms::default(),
            chip: ThisChip {
                hands: hands.clone(),
                stored: stored.clone(),
                looks: looks(now.brown_out_set),
                restarted,
            },
        };
        links.report(ArmingInhibit::BrownOutLevel, !now.brown_out_set);
        run.spawn();
        run
    }

    fn spawn(&self) {
        let (time, links) = (&self.time, self.links);
        time.spawn(imu::run(links, self.imu.clone()));
        time.spawn(estimator::run(links));
        time.spawn(control::run(links));
        time.spawn(mixer::run(links, |p| Flexible::new(Configuration::B, p)));
        time.spawn(motors::run(links, FakeMotors::default()));
        time.spawn(analog::run(links, self.analog.clone()));
        time.spawn(arms::run(links, self.arms.clone()));
        time.spawn(clamp::run(links));
        time.spawn(servos::run(links, FakeServos::default()));
        time.spawn(commander::run(links));
        let (line, screen) = (self.line.clone(), self.screen.clone());
        time.spawn(console::run(
            links,
            line,
            screen,
            self.chip.clone(),
            self.chip.clone(),
        ));
    }

    /// Runs until the board restarts or `stop` is set.
    fn serve(self, wire: &mut Wire, stop: &AtomicBool, all: &AtomicU64) {
        let mut ms = 0;
        while !stop.load(Ordering::Relaxed) {
            let begun = Instant::now();
            let hands = self.hands.lock().unwrap().clone();
            self.apply(&hands, ms);
            ms += ROUND_MS;
            all.fetch_add(ROUND_MS, Ordering::Relaxed);
            self.time.run_until(ms * 1000);
            let mut said = self.screen.text.take();
            let dies = hands
                .dies_at
                .is_some_and(|text| String::from_utf8_lossy(&said).contains(text));
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
            std::thread::sleep(ROUND.saturating_sub(begun.elapsed()));
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

    fn apply(&self, hands: &Hands, ms: u64) {
        self.imu.2.set(ImuReading {
            gyro: Vec3::ZERO,
            accel: hands.force + Vec3::new(0.0, 0.0, GRAVITY),
        });
        self.analog.frame.set(hands.counts);
        self.arms.0.set(hands.tilt);
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

fn looks(brown_out_set: bool) -> [Look; 2] {
    [
        Look {
            name: "revision",
            read: heapless::String::try_from("0x450 0x2003").unwrap(),
            expected: "0x2001 (X) or later",
            ok: true,
            inhibits: None,
        },
        Look {
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

#[derive(Clone)]
struct ThisChip {
    hands: Arc<Mutex<Hands>>,
    stored: Arc<Mutex<Params>>,
    looks: [Look; 2],
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
        let hands = self.hands.lock().unwrap();
        if hands.broken {
            return Err(StorageError::Broken);
        }
        if !hands.forgets {
            *self.stored.lock().unwrap() = *params;
        }
        Ok(())
    }

    async fn save_signing(&mut self, _: Option<Record>) -> Result<(), StorageError> {
        Err(StorageError::Broken)
    }
}

impl Chip for ThisChip {
    fn restart(&mut self) {
        self.restarted.set(true);
    }

    fn board(&self) -> &'static str {
        "table"
    }

    fn looks(&self) -> &[Look] {
        &self.looks
    }

    fn brown_out_volts(&self) -> f32 {
        2.6
    }

    async fn set_brown_out(&mut self) -> Result<(), NotSet> {
        self.hands.lock().unwrap().brown_out_set = true;
        Ok(())
    }
}
