//! InvenSense inertial sensors on SPI with a data-ready line; a [`Chip`] gives registers and bits. Detects a silent,
//! garbled or stuck part and a lost configuration.
//!
//! If the line is silent though the part answers correctly, the driver polls the part's status, so no sample counts
//! twice. The first comes 0.4 ms after detection (1.2 ms at 1 kHz), later ones up to a quarter period and one transfer
//! late, stamped with their request. [`line_watch`](crate::line_watch) decides when to use the line again.
//!
//! The caller bounds the wait by dropping the future of `read` (the imu task after 3 ms), which the next call treats as
//! a silence. Failures are followed by a pause (1 ms, doubling to 128 ms), so a dead part costs no processor time.

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use embedded_hal_async::spi::SpiDevice;
use heapless::Vec;
use sophie_control::chain::ImuReading;
use sophie_control::maths::scalar;
use sophie_control::maths::vector::Vec3;
use sophie_ports::error::PortError;
use sophie_ports::sensors::Imu;

use crate::fault::{Fault, report};
use crate::line_watch::LineWatch;
use crate::mounting::Mounting;
use crate::registers::{Registers, Setting};
use crate::self_test::{Limits, Measured, SAMPLES, SelfTest, Stage, judge};
use sophie_ports::data_ready::DataReady;

/// Bytes of one sample: accelerometer, gyroscope, temperature.
const SAMPLE: usize = 14;
const WATCHED: usize = 6;
/// Garbled samples in a row before a reset.
const GARBLED_MAX: u8 = 4;
/// Dropped waits in a row before a reset of a part with right registers.
const SILENCES_MAX: u8 = 2;
/// Longest polling without a sample: two periods at the slowest rate, below the caller's time-out.
const NOT_READY_MAX: Duration = Duration::from_millis(2);
/// Factor on `stuck_after` for the accelerometer, slower on some parts.
const ACCEL_PATIENCE: u16 = 4;
/// First and longest pause after a failure.
const PAUSE: [Duration; 2] = [Duration::from_millis(1), Duration::from_millis(128)];
/// Margin before power-on: no register may be written for 200 µs after it (DS-000347 §14.36).
const POWER_QUIET: Duration = Duration::from_micros(500);
const SELF_TEST_PERIOD: Duration = Duration::from_millis(1);
const SELF_TEST_ATTEMPTS: u16 = 2 * SAMPLES;
const NO_SAMPLE: i16 = i16::MIN;

/// Registers and their required contents.
pub type Settings = Vec<Setting, 32>;

/// One sample, counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Raw {
    /// Specific force.
    pub accel: [i16; 3],
    /// Angular rate.
    pub gyro: [i16; 3],
    /// Temperature.
    pub temperature: i16,
}

/// In-flight monitoring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watch {
    /// Samples between checks of identity and configuration; 0: none.
    pub check_every: u16,
    /// Equal gyroscope samples in a row of a stuck part; 0: no limit (a plant without noise).
    pub stuck_after: u16,
}

impl Watch {
    /// Checks every 100 ms; stuck after 16 equal samples, which noise excludes (two occur at 1 kHz, with noise below
    /// one count).
    pub const fn at(rate_hz: f32) -> Self {
        Self {
            check_every: (rate_hz * 0.1) as u16,
            stuck_after: 16,
        }
    }
}

impl Default for Watch {
    /// At 4 kHz.
    fn default() -> Self {
        Self::at(4000.0)
    }
}

/// Differences between the parts.
pub trait Chip {
    /// Name in messages.
    const NAME: &'static str;
    /// Rated SPI clock, Hz.
    const SPI_HZ: u32;
    /// Identity register.
    const WHO_AM_I: u8;
    /// Content of the identity register.
    const IDENTITY: u8;
    /// Identity and name of each part that is the same to the driver.
    const ALIKE: &'static [(u8, &'static str)];
    /// Bank select register, on parts that have banks.
    const BANK_SELECT: Option<u8>;
    /// First of the 14 data registers.
    const DATA: u8;
    /// First of six registers checked in flight, bank 0.
    const WATCH_FROM: u8;
    /// Status bit of a new sample, cleared by reading it.
    const SAMPLE_READY: Setting;
    /// Bank 0 registers that make the line pulse.
    const LINE: &'static [u8];
    /// Reset commands.
    const RESET: &'static [Setting];
    /// Duration of a reset.
    const RESET_TIME: Duration;
    /// Content left only by a reset.
    const AFTER_RESET: Setting;
    /// Makes the registers writable.
    const WAKE: &'static [Setting];
    /// Wait between [`Chip::WAKE`] and configuration.
    const WAKE_TIME: Duration;
    /// Switches both sensors on; written last.
    const POWER: Setting;
    /// Time from power to valid samples.
    const START_UP: Duration;
    /// Bank and first register of the gyroscope's self-test codes.
    const GYRO_CODES: (u8, u8);
    /// Bank and first register of the accelerometer's.
    const ACCEL_CODES: (u8, u8);
    /// Limits of the self-test.
    const SELF_TEST: Limits;

    /// Configuration before power-on.
    fn settings(&self) -> Settings;
    /// Configuration of a self-test stage, over [`Chip::settings`].
    fn self_test_settings(stage: Stage) -> Settings;
    /// Settling time of a self-test stage.
    fn self_test_time(stage: Stage) -> Duration;
    /// Sample from the seven words of a burst.
    fn arrange(words: [i16; 7]) -> Raw;
    /// Temperature, °C.
    fn celsius(raw: i16) -> f32;
    /// Data-ready pulses per sample read, at least 1.
    fn pulses_per_sample(&self) -> u8;
    /// Sample rate, Hz.
    fn rate_hz(&self) -> f32;
    /// Gyroscope range, °/s.
    fn gyro_range(&self) -> f32;
    /// Accelerometer range, g.
    fn accel_range(&self) -> f32;
    /// Monitoring limits.
    fn watch(&self) -> Watch;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Reset is due.
    Down(Instant),
    /// Reset ends.
    Resetting(Instant),
    /// Configuration is due.
    Waking(Instant),
    /// Power is being switched on; no register is written before.
    Powering(Instant),
    /// Configured; samples become valid.
    Settling(Instant),
    Running,
}

#[derive(Clone, Copy, Debug)]
struct Repeats {
    last: Option<[i16; 3]>,
    count: u16,
    alive: bool,
}

impl Repeats {
    const NEW: Self = Self {
        last: None,
        count: 0,
        alive: false,
    };

    /// Adds a value; true if the last `limit` were equal (0: never).
    fn too_many(&mut self, value: [i16; 3], limit: u16) -> bool {
        let same = self.last == Some(value);
        self.count = if same { self.count.saturating_add(1) } else { 1 };
        self.alive |= !same && self.last.is_some();
        self.last = Some(value);
        limit > 0 && self.count >= limit
    }
}

/// Driver of chip `C` on SPI device `S` with data-ready line `D`.
pub struct SpiImu<C, S, D> {
    chip: C,
    /// Identity and name of the part that answered, or is expected.
    part: (u8, &'static str),
    registers: Registers<S>,
    data_ready: D,
    ready_at: Instant,
    mounting: Mounting,
    state: State,
    pause: Duration,
    waiting: bool,
    silences: u8,
    line: LineWatch,
    garbled: u8,
    since_check: u16,
    gyro: Repeats,
    accel: Repeats,
    raw: Raw,
    temperature: f32,
    last_fault: Option<Fault>,
}

impl<C: Chip, S: SpiDevice, D: DataReady> SpiImu<C, S, D> {
    /// Without bus access until [`SpiImu::init`] or the first read. `data_ready` rises with each sample; `mounting`
    /// rotates the part's axes to the body's.
    pub const fn new(spi: S, data_ready: D, chip: C, mounting: Mounting) -> Self {
        let [pause, _] = PAUSE;
        Self {
            chip,
            part: (C::IDENTITY, C::NAME),
            registers: Registers::new(spi, C::BANK_SELECT),
            data_ready,
            ready_at: Instant::from_ticks(0),
            mounting,
            state: State::Down(Instant::from_ticks(0)),
            pause,
            waiting: false,
            silences: 0,
            line: LineWatch::new(),
            garbled: 0,
            since_check: 0,
            gyro: Repeats::NEW,
            accel: Repeats::NEW,
            raw: Raw {
                accel: [0; 3],
                gyro: [0; 3],
                temperature: 0,
            },
            temperature: 0.0,
            last_fault: None,
        }
    }

    /// Resets, identifies, configures and verifies the part, and waits for valid samples: about 50 ms (ICM-42688-P) or
    /// 190 ms (ICM-20689).
    ///
    /// # Errors
    /// The part's fault. The driver still serves as a port, which retries.
    pub async fn init(&mut self) -> Result<(), Fault> {
        let result = self.bring_up().await;
        self.note(result)
    }

    /// Actuates both sensors and compares their response with the factory codes; about 1.5 s, vehicle at rest. Then
    /// always resets and configures the part.
    ///
    /// # Errors
    /// The first axis that fails, or a fault of the part.
    pub async fn self_test(&mut self) -> Result<SelfTest, Fault> {
        let verdict = match self.bring_up().await {
            Ok(()) => self.actuate().await,
            Err(fault) => Err(fault),
        };
        self.state = State::Down(Instant::now());
        let restored = self.bring_up().await;
        self.note(restored)?;
        if let Err(fault) = &verdict {
            self.last_fault = Some(*fault);
            report(self.part.1, fault);
        }
        verdict
    }

    /// Name of the part that answered; before one did, of the one that is expected.
    pub const fn name(&self) -> &'static str {
        self.part.1
    }

    /// Die temperature at the last sample, °C.
    pub const fn temperature(&self) -> f32 {
        self.temperature
    }

    /// Last fault since power-up.
    pub const fn last_fault(&self) -> Option<Fault> {
        self.last_fault
    }

    /// Takes one sample, in counts, into `self`: a returned value would be copied at each level.
    async fn sample(&mut self) -> Result<(), Fault> {
        self.bring_up().await?;
        loop {
            self.next_raw().await?;
            // A part may still hang after its reset.
            if self.gyro.alive || self.chip.watch().stuck_after == 0 {
                return Ok(());
            }
        }
    }

    fn reading(&mut self) -> ImuReading {
        let raw = self.raw;
        self.temperature = C::celsius(raw.temperature);
        let gyro_scale = scalar::deg(self.chip.gyro_range() / 32768.0);
        let accel_scale = self.chip.accel_range() * (scalar::GRAVITY / 32768.0);
        ImuReading {
            gyro: self.mounting.to_body(scaled(raw.gyro, gyro_scale)),
            accel: self.mounting.to_body(scaled(raw.accel, accel_scale)),
        }
    }

    async fn next_raw(&mut self) -> Result<(), Fault> {
        if self.waiting {
            self.look_into_silence().await?;
        }
        self.waiting = true;
        if self.line.due().is_some() {
            self.next_by_clock().await?;
        } else {
            for _ in 0..self.chip.pulses_per_sample().max(1) {
                self.ready_at = self.data_ready.next().await;
            }
        }
        self.waiting = false;
        self.read_raw().await?;
        let raw = self.raw;
        let watch = self.chip.watch();
        let accel_limit = watch.stuck_after.saturating_mul(ACCEL_PATIENCE);
        // No short circuit: each counts.
        let gyro_stuck = self.gyro.too_many(raw.gyro, watch.stuck_after);
        if self.accel.too_many(raw.accel, accel_limit) || gyro_stuck {
            return Err(Fault::Stuck);
        }
        self.since_check = self.since_check.saturating_add(1);
        if watch.check_every > 0 && self.since_check >= watch.check_every {
            self.since_check = 0;
            self.check().await?;
        }
        Ok(())
    }

    /// Polls the status until a sample is new, and watches the line.
    async fn next_by_clock(&mut self) -> Result<(), Fault> {
        let give_up = Instant::now() + NOT_READY_MAX;
        let mut announced = false;
        while let Some(due) = self.line.due() {
            let in_time = Timer::at(due);
            if let Either::First(_) = select(self.data_ready.next(), in_time).await {
                // A pulse does not speed up the polls.
                announced = true;
                until(due).await;
            }
            let asked = Instant::now();
            let [status] = self.registers.read(C::SAMPLE_READY.register).await?;
            if C::SAMPLE_READY.compare(status).is_ok() {
                self.ready_at = asked;
                self.line.sample(asked, announced);
                break;
            }
            if asked >= give_up {
                return Err(Fault::Silent);
            }
            self.line.not_yet(asked);
        }
        Ok(())
    }

    async fn bring_up(&mut self) -> Result<(), Fault> {
        loop {
            match self.state {
                State::Running => return Ok(()),
                State::Down(at) => {
                    until(at).await;
                    // Another bank may be selected after a dropped transfer.
                    self.registers.select(0).await?;
                    self.registers.apply(C::RESET).await?;
                    self.state = State::Resetting(Instant::now() + C::RESET_TIME);
                }
                State::Resetting(at) => {
                    until(at).await;
                    self.identify().await?;
                    let [found] = self.registers.read(C::AFTER_RESET.register).await?;
                    if C::AFTER_RESET.compare(found).is_err() {
                        return Err(Fault::Reset {
                            register: C::AFTER_RESET.register,
                            found,
                        });
                    }
                    self.registers.apply(C::WAKE).await?;
                    self.state = State::Waking(Instant::now() + C::WAKE_TIME);
                }
                State::Waking(at) => {
                    until(at).await;
                    let settings = self.chip.settings();
                    self.registers.select(0).await?;
                    self.registers.apply(&settings).await?;
                    self.registers.verify(&settings).await?;
                    self.state = State::Powering(Instant::now() + POWER_QUIET);
                    self.registers.apply(&[C::POWER]).await?;
                }
                State::Powering(at) => {
                    until(at).await;
                    self.registers.verify(&[C::POWER]).await?;
                    self.state = State::Settling(Instant::now() + C::START_UP);
                }
                State::Settling(at) => {
                    until(at).await;
                    self.waiting = false;
                    self.silences = 0;
                    self.garbled = 0;
                    self.since_check = 0;
                    self.gyro = Repeats::NEW;
                    self.accel = Repeats::NEW;
                    self.state = State::Running;
                }
            }
        }
    }

    /// After a dropped wait: checks the part; if it is well, starts polling.
    async fn look_into_silence(&mut self) -> Result<(), Fault> {
        self.silences = self.silences.saturating_add(1);
        self.check().await?;
        if self.silences >= SILENCES_MAX {
            return Err(Fault::Silent);
        }
        if self.line.due().is_none() {
            let settings = self.chip.settings();
            let of_line = |s: &&Setting| s.bank == 0 && C::LINE.contains(&s.register);
            for setting in settings.iter().filter(of_line) {
                let [value] = self.registers.read(setting.register).await?;
                setting.compare(value)?;
            }
            // The unread status may be stale.
            let [_] = self.registers.read(C::SAMPLE_READY.register).await?;
            self.line.silent(Instant::now(), self.chip.rate_hz());
        }
        Ok(())
    }

    /// Looks which part it is, of those that the driver is for.
    async fn identify(&mut self) -> Result<(), Fault> {
        let [found] = self.registers.read(C::WHO_AM_I).await?;
        let expected = C::IDENTITY;
        let mut parts = C::ALIKE.iter().copied().chain([(expected, C::NAME)]);
        self.part = parts
            .find(|(identity, _)| *identity == found)
            .ok_or(Fault::Identity { expected, found })?;
        Ok(())
    }

    async fn check(&mut self) -> Result<(), Fault> {
        let (expected, _) = self.part;
        let [found] = self.registers.read(C::WHO_AM_I).await?;
        if found != expected {
            return Err(Fault::Identity { expected, found });
        }
        let read: [u8; WATCHED] = self.registers.read(C::WATCH_FROM).await?;
        let settings = self.chip.settings();
        for (register, value) in (C::WATCH_FROM..).zip(read) {
            let of_register = |s: &&Setting| s.bank == 0 && s.register == register;
            for setting in settings.iter().chain([&C::POWER]).filter(of_register) {
                setting.compare(value)?;
            }
        }
        Ok(())
    }

    async fn read_raw(&mut self) -> Result<(), Fault> {
        let bytes: [u8; SAMPLE] = self.registers.read(C::DATA).await?;
        let mut words = [0; SAMPLE / 2];
        for (word, pair) in words.iter_mut().zip(bytes.as_chunks().0) {
            *word = i16::from_be_bytes(*pair);
        }
        let raw = C::arrange(words);
        let silent_line = bytes.iter().all(|&b| b == 0x00) || bytes.iter().all(|&b| b == 0xFF);
        if silent_line || raw.gyro == [NO_SAMPLE; 3] || raw.accel == [NO_SAMPLE; 3] {
            return Err(Fault::Garbled);
        }
        self.raw = raw;
        Ok(())
    }

    async fn actuate(&mut self) -> Result<SelfTest, Fault> {
        let mut m = Measured::default();
        (m.gyro.rest, m.accel.rest) = self.stage(Stage::Rest).await?;
        (m.gyro.actuated, _) = self.stage(Stage::Gyro).await?;
        (_, m.accel.actuated) = self.stage(Stage::Accel).await?;
        m.gyro.codes = self.codes(C::GYRO_CODES).await?;
        m.accel.codes = self.codes(C::ACCEL_CODES).await?;
        judge(&m, &C::SELF_TEST)
    }

    async fn stage(&mut self, stage: Stage) -> Result<([f32; 3], [f32; 3]), Fault> {
        self.registers.apply(&C::self_test_settings(stage)).await?;
        Timer::after(C::self_test_time(stage)).await;
        let (mut gyro, mut accel, mut count) = ([0i32; 3], [0i32; 3], 0u16);
        for _ in 0..SELF_TEST_ATTEMPTS {
            Timer::after(SELF_TEST_PERIOD).await;
            if self.read_raw().await.is_err() {
                continue;
            }
            add(&mut gyro, self.raw.gyro);
            add(&mut accel, self.raw.accel);
            count += 1;
            if count == SAMPLES {
                let mean = |sum: [i32; 3]| sum.map(|s| s as f32 / f32::from(SAMPLES));
                return Ok((mean(gyro), mean(accel)));
            }
        }
        Err(Fault::Garbled)
    }

    async fn codes(&mut self, (bank, register): (u8, u8)) -> Result<[u8; 3], Fault> {
        self.registers.select(bank).await?;
        let codes = self.registers.read(register).await?;
        self.registers.select(0).await?;
        Ok(codes)
    }

    /// A failure schedules a reset after a pause.
    fn note<T>(&mut self, result: Result<T, Fault>) -> Result<T, Fault> {
        let Err(fault) = &result else { return result };
        let first = self.last_fault != Some(*fault);
        self.last_fault = Some(*fault);
        if *fault == Fault::Garbled && self.state == State::Running && self.garbled < GARBLED_MAX {
            // Paced by data-ready, and usually over with the next sample.
            self.garbled += 1;
            return result;
        }
        if first {
            report(self.part.1, fault);
        }
        let [_, longest] = PAUSE;
        self.state = State::Down(Instant::now() + self.pause);
        self.pause = (self.pause * 2).min(longest);
        result
    }
}

impl<C: Chip, S: SpiDevice, D: DataReady> Imu for SpiImu<C, S, D> {
    type Batch = [ImuReading; 1];

    fn rate_hz(&self) -> f32 {
        self.chip.rate_hz()
    }

    async fn read(&mut self) -> Result<[ImuReading; 1], PortError> {
        if let Err(fault) = self.sample().await {
            let _ = self.note::<()>(Err(fault));
            return Err(fault.port_error());
        }
        let [pause, _] = PAUSE;
        self.pause = pause;
        self.silences = 0;
        self.garbled = 0;
        Ok([self.reading()])
    }

    fn ready_at(&self) -> Instant {
        self.ready_at
    }

    fn line_silent(&self) -> bool {
        self.line.reported()
    }
}

async fn until(at: Instant) {
    if Instant::now() < at {
        Timer::at(at).await;
    }
}

fn scaled(counts: [i16; 3], scale: f32) -> Vec3 {
    Vec3::from(counts.map(|c| f32::from(c) * scale))
}

fn add(sum: &mut [i32; 3], counts: [i16; 3]) {
    for (sum, count) in sum.iter_mut().zip(counts) {
        *sum += i32::from(count);
    }
}
