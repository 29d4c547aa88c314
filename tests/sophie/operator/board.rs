//! A board on a table, with MAVLink over TCP or a serial port, or its text console there: the task of the line and the
//! tasks that it asks, on scripted parts. Its time runs faster than the clock on the wall, its stored parameters outlive
//! its restarts.

use std::cell::{Cell, RefCell};
use std::io::Write;
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
use sophie_control::gripper::contact_pressure::FsrScale;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::mode::Mode;
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
use sophie_sim::plant::{Actuators, Plant, STEP};
use sophie_sim::scenario::Scenario;
use sophie_sim::sensors::fsr::{FsrErrors, FsrSensor};
use sophie_sim::streams::Streams;
use sophie_tasks::console;
use sophie_tasks::flight::{control, estimator, imu, mixer, motors};
use sophie_tasks::ground_station::console_pipe::ConsolePipe;
use sophie_tasks::ground_station::mavlink::{self, Lines};
use sophie_tasks::links::Links;
use sophie_tasks::navigation::barometer;
use sophie_tasks::perching::{analog, arms, clamp, servos};
use sophie_tasks::pilot::commander;

use super::wire::Wire;

/// The board's time in one round, ms, and the time on the wall that a round takes at least: twenty times real time.
const ROUND_MS: u64 = 10;
const ROUND: Duration = Duration::from_micros(500);
/// Weight that hands hang on or take off in a round, N: 3 N in a second.
const HANG: f64 = 0.03;
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
    /// Pressure sensors in the cradle for their loads, beside the counts.
    pub pads: Option<Pads>,
    /// Tilt of each arm's tip, rad.
    pub tilt: PerArm<f32>,
    /// The vehicle that stands on a box, whose servos wind its arms: these have the tilts then. `None`: there is no vehicle.
    pub vehicle: Option<Arc<Scenario>>,
    /// Weight on each arm's tip, N.
    pub hung: PerArm<f64>,
    /// What the barometer reads, Pa; `None`: nothing.
    pub air: Option<f32>,
    /// What the receiver gives at 50 Hz; `None`: nothing.
    pub sticks: Option<Sticks>,
    /// The board takes what is typed and says nothing.
    pub mute: bool,
    /// It falls silent for good when it says that this parameter has this value.
    pub dies_at: Option<(&'static str, f32)>,
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
    /// The plug is pulled when it says that this parameter has this value.
    pub unplugged_at: Option<(&'static str, f32)>,
    /// Which board it says it is.
    pub board: &'static str,
    /// Which image it is said to be.
    pub build: u32,
    /// How the motors are wired.
    pub wiring: MotorMap,
    /// Its time is that of the wall.
    pub real_time: bool,
    /// Its time runs twice as fast only: who renews an order has two thirds of a second.
    pub unhurried: bool,
    /// It is powered off and on.
    pub power_cycle: bool,
}

/// Sensors as their simulation has them.
#[derive(Clone, Debug)]
pub struct Pads {
    /// Seed of their parts.
    pub seed: u64,
    /// Gain and errors of each.
    pub of: PerArm<(f64, FsrErrors)>,
    /// Loads, N.
    pub load: PerArm<f64>,
    /// Bend of each arm's skin, rad.
    pub bend: PerArm<f64>,
}

impl Pads {
    /// Bend of an arm on the pipe and in its cradle, rad.
    pub const BEND: f64 = 1.19;
    /// Area of a pad, m².
    pub const AREA: f64 = 0.038 * 0.038;

    fn sensor(&self, arm: usize) -> FsrSensor {
        let (gain, errors) = self.of[arm];
        let sensor = FsrSensor::new(arm, Streams::new(self.seed));
        sensor.with_fault(gain, None).with_errors(errors)
    }

    /// What the sensor of `arm` reads with `params` at `pressure`, Pa: the mean of a rise from none and of a fall from
    /// half more.
    pub fn reads(&self, arm: usize, params: &Params, pressure: f64) -> f64 {
        let (mut sensor, scale) = (self.sensor(arm), FsrScale::from_params(params, arm));
        sensor.bend(Self::BEND);
        let mut mean_from = |share: f64| {
            let readings = (0..1000).map(|step| {
                let way = (f64::from(step) / 400.0).min(1.0);
                let counts = sensor.sample(pressure * (share + way * (1.0 - share)), 0.002);
                f64::from(scale.pressure(counts))
            });
            readings.skip(750).sum::<f64>() / 250.0
        };
        0.5 * (mean_from(0.0) + mean_from(1.5))
    }
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
            pads: None,
            tilt: [0.0; 4],
            vehicle: None,
            hung: [0.0; 4],
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
            unhurried: false,
            power_cycle: false,
        }
    }
}

/// The board and its thread, which ends with it.
pub struct Board {
    /// Name of its line, as `--port` takes it.
    name: String,
    hands: Arc<Mutex<Hands>>,
    stored: Arc<Mutex<Params>>,
    outputs: Arc<Mutex<Outputs>>,
    /// The board's time over all its starts, ms.
    ms: Arc<AtomicU64>,
    /// Changes of parameters that it has reported.
    changes: Arc<AtomicU64>,
    /// Its mode, and that nothing forbids arming.
    mode: Arc<Mutex<Option<(Mode, bool)>>>,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Board {
    /// Powers a board up, with MAVLink on a socket.
    pub fn new(hands: Hands) -> Self {
        Self::with_stored(hands, Params::DEFAULT)
    }

    /// The same with its frames signed by `key`.
    pub fn with_key(hands: Hands, key: Option<Key>) -> Self {
        Self::starting(Wire::socket(), hands, Protocol::Mavlink(key), Params::DEFAULT)
    }

    /// MAVLink on a serial port.
    #[cfg(target_os = "linux")]
    pub fn on_serial(hands: Hands) -> Self {
        Self::starting(Wire::serial(), hands, Protocol::Mavlink(None), Params::DEFAULT)
    }

    /// The pads of its console at a serial port.
    #[cfg(target_os = "linux")]
    pub fn at_its_console(hands: Hands) -> Self {
        Self::starting(Wire::serial(), hands, Protocol::Console, Params::DEFAULT)
    }

    /// With the parameters that it has stored.
    pub fn with_stored(hands: Hands, stored: Params) -> Self {
        Self::starting(Wire::socket(), hands, Protocol::Mavlink(None), stored)
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
        let mode = Arc::<Mutex<Option<(Mode, bool)>>>::default();
        let seen = Seen {
            mode: mode.clone(),
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
            mode,
            stop,
            thread: Some(thread),
        }
    }

    /// Name of its line, as `--port` takes it.
    pub fn name(&self) -> String {
        self.name.clone()
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

    /// Sends `bytes` over a connection of its own, which is gone afterwards.
    pub fn send_and_leave(&self, bytes: &[u8]) {
        let mut user = TcpStream::connect(self.name.strip_prefix("tcp:").unwrap()).unwrap();
        user.write_all(bytes).unwrap();
        // Until the board has read them.
        self.pass(0.5);
    }

    /// Waits until it is in `mode`, and nothing forbids arming if it is `free`.
    pub fn until(&self, mode: Mode, free: bool) {
        let begun = Instant::now();
        loop {
            let now = *self.mode.lock().unwrap();
            if now.is_some_and(|(now, arms)| now == mode && (arms || !free)) {
                return;
            }
            assert!(begun.elapsed() < PATIENCE, "{now:?}");
            std::thread::sleep(ROUND);
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
    mode: Arc<Mutex<Option<(Mode, bool)>>>,
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
    pads: RefCell<Option<PerArm<FsrSensor>>>,
    barometer: FakeBarometer,
    arms: Arms,
    motors: FakeMotors,
    servos: FakeServos,
    stand: Option<RefCell<Stand>>,
    chip: ThisChip,
}

/// A vehicle on a box.
struct Stand {
    plant: Plant,
    hung: PerArm<f64>,
}

impl Stand {
    fn of(scenario: &Scenario) -> Self {
        let mut plant = scenario.plant();
        plant.stand(true);
        Self {
            plant,
            hung: [0.0; 4],
        }
    }

    /// A round under the servos' `pulses`, us, while hands bring the weights to `hung` N; the arms' tilts.
    fn round(&mut self, pulses: PerArm<f32>, hung: PerArm<f64>) -> PerArm<f32> {
        for (arm, (now, to)) in self.hung.iter_mut().zip(hung).enumerate() {
            *now += (to - *now).clamp(-HANG, HANG);
            self.plant.hang(arm, *now);
        }
        for _ in 0..(1e-3 * ROUND_MS as f64 / STEP) as u32 {
            self.plant.step(&Actuators {
                motors: [0.0; 4],
                servos: pulses.map(f64::from),
            });
        }
        self.plant.tilt().map(|tilt| tilt as f32)
    }
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
            pads: RefCell::new(now.pads.map(|pads| std::array::from_fn(|arm| pads.sensor(arm)))),
            barometer: FakeBarometer::default(),
            arms: Arms::default(),
            motors: FakeMotors::default(),
            servos: FakeServos::default(),
            stand: now
                .vehicle
                .as_deref()
                .map(|scenario| RefCell::new(Stand::of(scenario))),
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
        time.spawn(console::run(
            links,
            shell.port(),
            shell.port(),
            chip.clone(),
            chip,
        ));
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
            let status = self.links.status.latest();
            *seen.mode.lock().unwrap() = status.map(|it| (it.value.mode, it.value.inhibits.is_empty()));
            let mut said = self.screen.text.take();
            let frames = self.frames.as_ref().map(|frames| frames.take(hands.drops));
            let parameters: Vec<(String, f32)> = frames
                .iter()
                .flatten()
                .filter_map(|frame| parameter(frame))
                .collect();
            let says = |it: Option<(&str, f32)>| {
                it.is_some_and(|(name, value)| parameters.contains(&(name.to_owned(), value)))
            };
            let stored = *self.chip.stored.lock().unwrap();
            if parameters
                .iter()
                .any(|(name, value)| stored.get(name) != Some(*value))
            {
                seen.changes.fetch_add(1, Ordering::Relaxed);
            }
            let (dies, unplugged) = (says(hands.dies_at), says(hands.unplugged_at));
            said.extend(frames.into_iter().flatten().flatten());
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
            } else if hands.unhurried {
                Duration::from_millis(ROUND_MS) / 2
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
        let mut counts = hands.counts;
        let mut pads = self.pads.borrow_mut();
        for (arm, (sensor, counts)) in pads.iter_mut().flatten().zip(&mut counts.fsr).enumerate() {
            let held = hands.pads.as_ref().map(|pads| (pads.load[arm], pads.bend[arm]));
            let (load, bend) = held.unwrap_or_default();
            sensor.bend(bend);
            *counts = sensor
                .sample(load / Pads::AREA, ROUND_MS as f64 * 1e-3)
                .max(*counts);
        }
        self.analog.frame.set(counts);
        let pulses = self.servos.pulses.borrow().last().copied().unwrap_or_default();
        let stand = self.stand.as_ref();
        self.arms
            .0
            .set(stand.map_or(hands.tilt, |stand| stand.borrow_mut().round(pulses, hands.hung)));
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

/// Frames that are said, each in one write.
#[derive(Clone, Default)]
struct Frames {
    said: Rc<RefCell<Vec<Vec<u8>>>>,
    count: Rc<Cell<usize>>,
}

impl Frames {
    /// What has been said, less each `drops`th frame.
    fn take(&self, drops: Option<usize>) -> Vec<Vec<u8>> {
        let mut said = self.said.take();
        said.retain(|_| {
            self.count.set(self.count.get() + 1);
            drops.is_none_or(|every| !self.count.get().is_multiple_of(every))
        });
        said
    }
}

/// Name and value in a frame of MAVLink 2, if it is a `PARAM_VALUE` (22): ten bytes of header, then the value, count and
/// place, and the name.
fn parameter(frame: &[u8]) -> Option<(String, f32)> {
    let (value, name) = (frame.get(10..14)?, frame.get(18..34)?);
    let name = name.split(|byte| *byte == 0).next()?;
    let is_value = frame.get(7..10)? == [22, 0, 0];
    is_value.then(|| {
        let value = f32::from_le_bytes(value.try_into().unwrap());
        (String::from_utf8_lossy(name).into_owned(), value)
    })
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
