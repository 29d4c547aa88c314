//! Scripted ports: they answer, fail or never answer.

use std::cell::{Cell, RefCell};
use std::future::pending;
use std::rc::Rc;

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::signal::Signal;
use embassy_time::{Duration, Instant, Timer};
use heapless::Vec as Few;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::chain::ImuReading;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_control::params::Params;
use sophie_ports::actuators::{Motors, Servos};
use sophie_ports::chip::Watchdog;
use sophie_ports::error::PortError;
use sophie_ports::retained::{Retain, WORDS, Words};
use sophie_ports::sensors::{Analog, AnalogFrame, ArmImus, Barometer, IMU_BATCH, Imu};
use sophie_ports::serial::SerialInput;

/// Answer of a port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Answer {
    /// A correct answer.
    #[default]
    Sound,
    /// An error after the time of a reading.
    Fails,
    /// An error at once, as from a part without set-up.
    Refuses,
    /// This error after the time of a reading.
    Errs(PortError),
    /// No answer.
    Hangs,
}

/// Number of port calls in a row, without time between them, that only a faulty task makes.
const SPIN: u32 = 1000;

/// A part with its present answer, and a check for tasks that ask it without waiting.
#[derive(Clone, Default)]
pub struct Part {
    /// Present answer.
    pub answer: Rc<Cell<Answer>>,
    /// A task asked it again and again without ever waiting.
    pub spun: Rc<Cell<bool>>,
    /// Errors given with [`Answer::Errs`], as long as the test does not set it back.
    pub failed: Rc<Cell<u32>>,
    asked: Rc<Cell<(u64, u32)>>,
}

impl Part {
    /// Takes `us` microseconds, then succeeds or fails; or does neither.
    async fn work(&self, us: u64) -> Result<(), PortError> {
        let now = Instant::now().as_micros();
        let (at, count) = self.asked.get();
        self.asked.set(if at == now { (at, count + 1) } else { (now, 1) });
        if self.asked.get().1 > SPIN {
            // On a board nothing else would ever run again; here the test must end.
            self.spun.set(true);
            return pending().await;
        }
        match self.answer.get() {
            Answer::Sound => {
                Timer::after_micros(us).await;
                Ok(())
            }
            Answer::Fails => {
                Timer::after_micros(us).await;
                Err(PortError::Timeout)
            }
            Answer::Errs(error) => {
                Timer::after_micros(us).await;
                self.failed.set(self.failed.get() + 1);
                Err(error)
            }
            Answer::Refuses => Err(PortError::Absent),
            Answer::Hangs => pending().await,
        }
    }
}

/// A level inertial sensor of 1 kHz at rest; the test may silence its data-ready line and set its reading besides
/// gravity.
#[derive(Clone, Default)]
pub struct FakeImu(pub Part, pub Rc<Cell<bool>>, pub Rc<Cell<ImuReading>>);

impl Imu for FakeImu {
    type Batch = Few<ImuReading, IMU_BATCH>;

    fn rate_hz(&self) -> f32 {
        1000.0
    }

    async fn read(&mut self) -> Result<Self::Batch, PortError> {
        self.0.work(1000).await?;
        let mut batch = Few::new();
        let _ = batch.push(ImuReading {
            gyro: self.2.get().gyro,
            accel: self.2.get().accel + Vec3::new(0.0, 0.0, -GRAVITY),
        });
        Ok(batch)
    }

    fn ready_at(&self) -> Instant {
        Instant::now()
    }

    fn line_silent(&self) -> bool {
        self.1.get()
    }
}

/// Arm sensors that see arms on a level body: their bus, each of them, and the tilt of the left arms' tips, rad.
#[derive(Clone, Default)]
pub struct FakeArms(pub Part, pub [Part; 4], pub Rc<Cell<f32>>);

impl ArmImus for FakeArms {
    async fn gravity(&mut self, arm: usize) -> Result<Vec3, PortError> {
        self.0.work(400).await?;
        self.1[arm].work(10).await?;
        let left = if arm < 2 { self.2.get() } else { 0.0 };
        Ok(Vec3::new(
            0.0,
            GRAVITY * libm::sinf(left),
            GRAVITY * libm::cosf(left),
        ))
    }
}

/// A barometer that takes 15 ms and gives what the test sets, Pa, as of its middle.
#[derive(Clone, Default)]
pub struct FakeBarometer(pub Part, pub Rc<Cell<f32>>);

impl Barometer for FakeBarometer {
    const FITTED: bool = true;

    async fn read(&mut self) -> Result<AirPressure, PortError> {
        let at_us = Instant::now().as_micros() + 7500;
        self.0.work(15_000).await?;
        Ok(AirPressure {
            at_us,
            pascal: self.1.get(),
            celsius: 30.0,
        })
    }
}

/// A converter with a frame that the test sets.
#[derive(Clone, Default)]
pub struct FakeAnalog {
    /// The converter.
    pub part: Part,
    /// Time that a conversion takes beyond the usual 30 µs, µs.
    pub delay_us: Rc<Cell<u64>>,
    /// The frame of the next conversion.
    pub frame: Rc<Cell<AnalogFrame>>,
}

/// Battery voltage for each count by the parameters' default divider, V.
pub const VOLTS_PER_COUNT: f32 = 0.01;

impl Analog for FakeAnalog {
    fn volts_per_count(&self) -> f32 {
        VOLTS_PER_COUNT / Params::DEFAULT.battery_divider
    }

    async fn read(&mut self) -> Result<AnalogFrame, PortError> {
        self.part.work(30 + self.delay_us.get()).await?;
        Ok(self.frame.get())
    }
}

/// Motors that remember their last commands.
#[derive(Clone, Default)]
pub struct FakeMotors {
    /// The timer.
    pub part: Part,
    /// The last commands, 0 to 1.
    pub commands: Rc<Cell<PerArm<f32>>>,
}

impl Motors for FakeMotors {
    async fn write(&mut self, commands: PerArm<f32>) -> Instant {
        let began = Instant::now();
        self.commands.set(commands);
        let _ = self.part.work(20).await;
        began
    }
}

/// Servos that remember every pulse.
#[derive(Clone, Default)]
pub struct FakeServos {
    /// The timer.
    pub part: Part,
    /// Remaining time of the frame in which widths are written, µs.
    pub frame_us: Rc<Cell<u64>>,
    /// Every pulse so far, µs.
    pub pulses: Rc<RefCell<Vec<PerArm<f32>>>>,
}

impl FakeServos {
    /// The pulses on the wires now, µs.
    pub fn now(&self) -> PerArm<f32> {
        self.pulses.borrow().last().copied().unwrap_or_default()
    }
}

impl Servos for FakeServos {
    async fn write(&mut self, pulses_us: PerArm<f32>) -> Instant {
        self.pulses.borrow_mut().push(pulses_us);
        let _ = self.part.work(20).await;
        Instant::now() + Duration::from_micros(self.frame_us.get())
    }
}

/// A receiver's line: bytes that the test puts on it arrive at once.
#[derive(Clone, Default)]
pub struct FakeLine {
    bytes: Rc<RefCell<Vec<u8>>>,
    news: Rc<Line>,
}

struct Line(Signal<CriticalSectionRawMutex, ()>);

impl Default for Line {
    fn default() -> Self {
        Self(Signal::new())
    }
}

impl FakeLine {
    /// Puts `bytes` on the line.
    pub fn put(&self, bytes: &[u8]) {
        self.bytes.borrow_mut().extend_from_slice(bytes);
        self.news.0.signal(());
    }

    /// Bytes not yet read.
    pub fn waiting(&self) -> usize {
        self.bytes.borrow().len()
    }
}

impl SerialInput for FakeLine {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        while self.bytes.borrow().is_empty() {
            self.news.0.wait().await;
        }
        let mut bytes = self.bytes.borrow_mut();
        let count = bytes.len().min(buffer.len());
        for (slot, byte) in buffer.iter_mut().zip(bytes.drain(..count)) {
            *slot = byte;
        }
        Ok(count)
    }
}

/// A receiver with a broken line: only errors, or reads without a byte.
#[derive(Clone, Default)]
pub struct BrokenLine(pub Part);

impl SerialInput for BrokenLine {
    async fn read(&mut self, _buffer: &mut [u8]) -> Result<usize, PortError> {
        self.0.work(100).await?;
        Ok(0)
    }
}

/// A watchdog that remembers when it was fed, µs.
#[derive(Clone, Default)]
pub struct FakeWatchdog(pub Rc<RefCell<Vec<u64>>>);

impl FakeWatchdog {
    /// Feeds from `from_us` on.
    pub fn fed_since(&self, from_us: u64) -> usize {
        self.0.borrow().iter().filter(|t| **t >= from_us).count()
    }
}

impl Watchdog for FakeWatchdog {
    fn feed(&mut self) {
        self.0.borrow_mut().push(Instant::now().as_micros());
    }
}

/// Memory that outlives a reset: both copies, and how often each was written.
#[derive(Clone)]
pub struct FakeMemory(pub Rc<Cell<([Words; 2], [u32; 2])>>);

impl Default for FakeMemory {
    fn default() -> Self {
        Self(Rc::new(Cell::new(([[0; WORDS]; 2], [0; 2]))))
    }
}

impl FakeMemory {
    /// Present contents.
    pub fn copies(&self) -> [Words; 2] {
        self.0.get().0
    }
}

impl Retain for FakeMemory {
    fn keep(&mut self, second: bool, words: &Words) {
        let (mut copies, mut writes) = self.0.get();
        copies[usize::from(second)] = *words;
        writes[usize::from(second)] += 1;
        self.0.set((copies, writes));
    }
}
