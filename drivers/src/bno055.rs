//! Bosch BNO055 on I2C: the sensor at an arm's tip, used for its fused gravity vector. Section numbers are
//! those of BST-BNO055-DS000 rev. 1.4.
//!
//! The chip is slow and moody: 650 ms from reset, 19 ms into and 7 ms out of its configuration mode, a clock
//! that it stretches, and now and then a reset of its own. So nothing here waits: each call does one short
//! step, of at most a few register accesses that are bounded each, and says [`PortError::Absent`] until the
//! chip is ready. A chip that does not answer is asked again after a pause that doubles up to 1 s.

use embassy_time::{Duration, Instant, with_timeout};
use embedded_hal_async::i2c::I2c;
use sophie_control::vector::Vec3;
use sophie_tasks::ports::PortError;

use crate::fault::{Fault, report};
use crate::mounting::Mounting;

/// Longest time that one transaction may take. The longest here has 19 bytes: 0.43 ms at 400 kHz.
pub const TRANSACTION: Duration = Duration::from_millis(3);
/// From a reset until registers can be written (§1.2: 650 ms), and some.
const RESET_TIME: Duration = Duration::from_millis(700);
/// From any mode to the configuration mode (§3.3, table 3-6).
const TO_CONFIG: Duration = Duration::from_millis(19);
/// From the configuration mode to any other (§3.3, table 3-6), and the first fused sample at 100 Hz.
const FROM_CONFIG: Duration = Duration::from_millis(7 + 10);
/// First and longest pause between attempts at a chip that does not answer.
const PAUSE: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(1)];
/// Failed readings in a row after which the chip is taken for lost.
const FAILURES_MAX: u8 = 3;
/// Longest time that the fusion may take to start, or be out of action.
const FUSION_LIMIT: Duration = Duration::from_secs(2);

/// Counts for each m/s² of the gravity vector (§3.6.5.7).
const COUNTS_PER_UNIT: f32 = 100.0;
/// Believable length of the gravity vector, m/s², squared: the fusion scales it to 9.8.
const LENGTH_SQUARED: core::ops::RangeInclusive<f32> = 8.0 * 8.0..=12.0 * 12.0;

mod reg {
    //! Addresses on page 0, §4.2.
    pub const CHIP_ID: u8 = 0x00;
    pub const PAGE_ID: u8 = 0x07;
    pub const GRV_DATA_X_LSB: u8 = 0x2E;
    pub const UNIT_SEL: u8 = 0x3B;
    pub const OPR_MODE: u8 = 0x3D;
    pub const PWR_MODE: u8 = 0x3E;
    pub const SYS_TRIGGER: u8 = 0x3F;
    pub const AXIS_MAP_CONFIG: u8 = 0x41;
    pub const AXIS_MAP_SIGN: u8 = 0x42;
}

/// What the chip id register holds (§4.3.1).
pub const CHIP_ID: u8 = 0xA0;
/// PAGE_ID, which both pages have: the page without the registers above is selected.
const OTHER_PAGE: u8 = 1;
/// SYS_TRIGGER: reset the whole system.
const RST_SYS: u8 = 0x20;
/// UNIT_SEL: m/s², °/s, degrees, °C; Android's sense of pitch, the reset value.
const UNITS: u8 = 0x80;
/// SYS_STATUS: the fusion runs.
const FUSION_RUNS: u8 = 5;
/// SYS_STATUS: the chip has found an error.
const SYSTEM_ERROR: u8 = 1;
/// OPR_MODE: the configuration mode.
const CONFIG_MODE: u8 = 0x00;
/// Axis map of a chip that hands its own axes out (§3.4): [`Mounting`] turns them instead, so that a quarter
/// turn needs no reading of the datasheet's sign rule.
const AXES: [u8; 2] = [0x24, 0x00];

/// Address of a chip on its bus, chosen by its COM3 pin (§4.6).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Address {
    /// COM3 low.
    Low = 0x28,
    /// COM3 high.
    High = 0x29,
}

/// Fusion mode (§3.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Fusion {
    /// Accelerometer and gyroscope: what an arm beside a motor wants, whose magnets would turn a compass.
    #[default]
    ImuPlus = 0x08,
    /// With the magnetometer.
    Ndof = 0x0C,
}

/// What is configured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Fusion mode.
    pub fusion: Fusion,
    /// How the chip sits on the straight arm, in body axes.
    pub mounting: Mounting,
    /// Least calibration of the gyroscope, 0 (none) to 3 (full), for a reading to be given.
    pub gyro_calibration_min: u8,
}

impl Default for Config {
    /// Accelerometer and gyroscope, marking up and x forward, a gyroscope that has begun to calibrate.
    fn default() -> Self {
        Self {
            fusion: Fusion::default(),
            mounting: Mounting::default(),
            gyro_calibration_min: 1,
        }
    }
}

/// Calibration of the chip, each 0 (none) to 3 (full) (§4.3.54).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Calibration {
    /// The fusion as a whole.
    pub system: u8,
    /// The gyroscope: at rest for a few seconds.
    pub gyro: u8,
    /// The accelerometer: six positions.
    pub accel: u8,
    /// The magnetometer: a figure of eight.
    pub magnetometer: u8,
}

impl Calibration {
    const fn from_register(value: u8) -> Self {
        Self {
            system: value >> 6,
            gyro: (value >> 4) & 3,
            accel: (value >> 2) & 3,
            magnetometer: value & 3,
        }
    }
}

/// How far a chip has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// To be asked for its identity at this time.
    Absent(Instant),
    /// Reset commanded; over at this time.
    Resetting(Instant),
    /// Mode switched to configuration; over at this time.
    Entering(Instant),
    /// Mode switched to fusion; over at this time.
    Leaving(Instant),
    /// Readings come; the last good one came at this time.
    Running(Instant),
}

/// One chip. The bus is lent to each call, since two chips share it.
pub struct Bno055 {
    address: Address,
    config: Config,
    state: State,
    pause: Duration,
    failures: u8,
    calibration: Calibration,
    last_fault: Option<Fault>,
}

impl Bno055 {
    /// A chip at `address`; nothing happens on the bus before the first [`Bno055::gravity`].
    pub const fn new(address: Address, config: Config) -> Self {
        let [pause, _] = PAUSE;
        Self {
            address,
            config,
            // The chip was powered with the processor: before it has booted, it need not be asked.
            state: State::Absent(Instant::from_millis(RESET_TIME.as_millis())),
            pause,
            failures: 0,
            calibration: Calibration::from_register(0),
            last_fault: None,
        }
    }

    /// Calibration at the last reading.
    pub const fn calibration(&self) -> Calibration {
        self.calibration
    }

    /// What went wrong last, if anything did since power-up.
    pub const fn last_fault(&self) -> Option<Fault> {
        self.last_fault
    }

    /// True while readings come.
    pub const fn is_running(&self) -> bool {
        matches!(self.state, State::Running(_))
    }

    /// Takes the chip one step further, or reads it: the direction of gravity in the axes of its mounting,
    /// m/s²; (0, 0, 9.8) for a level chip.
    ///
    /// # Errors
    /// `Absent` while the chip is not there, not ready or not calibrated; `Timeout` and `Corrupt` for a
    /// reading that failed.
    pub async fn gravity(&mut self, bus: &mut impl I2c) -> Result<Vec3, PortError> {
        let now = Instant::now();
        match self.state {
            State::Absent(at) | State::Resetting(at) | State::Entering(at) | State::Leaving(at)
                if now < at =>
            {
                Err(PortError::Absent)
            }
            State::Running(since) => self.reading(bus, since).await,
            _ => {
                if let Err(lost) = self.advance(bus).await {
                    self.lose(lost);
                }
                Err(PortError::Absent)
            }
        }
    }

    /// The next step towards running.
    async fn advance(&mut self, bus: &mut impl I2c) -> Result<(), Lost> {
        self.state = match self.state {
            State::Absent(_) => {
                self.identify(bus).await?;
                // Whatever the chip did before a reset of the processor, it is configured from its reset state.
                self.write(bus, reg::PAGE_ID, 0).await?;
                self.write(bus, reg::SYS_TRIGGER, RST_SYS).await?;
                State::Resetting(Instant::now() + RESET_TIME)
            }
            State::Resetting(_) => {
                self.identify(bus).await?;
                self.write(bus, reg::PAGE_ID, 0).await?;
                self.write(bus, reg::OPR_MODE, CONFIG_MODE).await?;
                State::Entering(Instant::now() + TO_CONFIG)
            }
            State::Entering(_) => {
                self.configure(bus).await?;
                self.write(bus, reg::OPR_MODE, self.config.fusion as u8).await?;
                State::Leaving(Instant::now() + FROM_CONFIG)
            }
            State::Leaving(_) | State::Running(_) => {
                self.failures = 0;
                State::Running(Instant::now())
            }
        };
        Ok(())
    }

    /// Writes the configuration and reads it back.
    async fn configure(&self, bus: &mut impl I2c) -> Result<(), Lost> {
        let [axes, signs] = AXES;
        let settings = [
            (reg::PWR_MODE, 0x00),
            (reg::UNIT_SEL, UNITS),
            (reg::AXIS_MAP_CONFIG, axes),
            (reg::AXIS_MAP_SIGN, signs),
        ];
        // Internal clock, no self-test. A write-only register: there is nothing to read back.
        self.write(bus, reg::SYS_TRIGGER, 0x00).await?;
        for (register, value) in settings {
            self.write(bus, register, value).await?;
        }
        for (register, expected) in settings {
            let [found] = self.read(bus, register).await?;
            if found != expected {
                return Err(Lost::Fault(Fault::Configuration {
                    bank: 0,
                    register,
                    expected,
                    found,
                }));
            }
        }
        Ok(())
    }

    /// Finds the chip on either page. What shows no page of a BNO055 is not written to.
    async fn identify(&self, bus: &mut impl I2c) -> Result<(), Lost> {
        let [mut found] = self.read(bus, reg::CHIP_ID).await?;
        // A reset of the processor alone, or a glitch on the bus, leaves the chip on the page that has no identity.
        if found != CHIP_ID && self.read(bus, reg::PAGE_ID).await? == [OTHER_PAGE] {
            self.write(bus, reg::PAGE_ID, 0).await?;
            [found] = self.read(bus, reg::CHIP_ID).await?;
        }
        if found == CHIP_ID {
            Ok(())
        } else {
            Err(Lost::Fault(Fault::Identity {
                expected: CHIP_ID,
                found,
            }))
        }
    }

    /// One reading, with the status that validates it, in one burst.
    async fn reading(&mut self, bus: &mut impl I2c, since: Instant) -> Result<Vec3, PortError> {
        match self
            .read::<16>(bus, reg::GRV_DATA_X_LSB)
            .await
            .and_then(|bytes| self.judge(bytes, since))
        {
            Ok(Some(gravity)) => {
                let [pause, _] = PAUSE;
                self.pause = pause;
                self.failures = 0;
                self.state = State::Running(Instant::now());
                Ok(gravity)
            }
            Ok(None) => Err(PortError::Absent),
            Err(lost) => {
                self.failures = self.failures.saturating_add(1);
                // A chip that has left its mode will not come back by itself.
                let left = matches!(lost, Lost::Fault(Fault::Configuration { .. } | Fault::Silent));
                if left || self.failures >= FAILURES_MAX {
                    self.lose(lost);
                }
                Err(lost.port_error())
            }
        }
    }

    /// What a burst from GRV_DATA to OPR_MODE says; `None` while the fusion starts or calibrates.
    fn judge(&mut self, bytes: [u8; 16], since: Instant) -> Result<Option<Vec3>, Lost> {
        let [
            xl,
            xh,
            yl,
            yh,
            zl,
            zh,
            _temperature,
            calibration,
            _,
            _,
            _,
            status,
            _error,
            units,
            _,
            mode,
        ] = bytes;
        let expect = |register, expected, found| {
            if expected == found {
                Ok(())
            } else {
                Err(Lost::Fault(Fault::Configuration {
                    bank: 0,
                    register,
                    expected,
                    found,
                }))
            }
        };
        if bytes.iter().all(|&b| b == 0x00) || bytes.iter().all(|&b| b == 0xFF) {
            return Err(Lost::Fault(Fault::Garbled));
        }
        // A chip that reset itself is in its configuration mode.
        expect(reg::OPR_MODE, self.config.fusion as u8, mode & 0x0F)?;
        expect(reg::UNIT_SEL, UNITS, units)?;
        self.calibration = Calibration::from_register(calibration);
        if status != FUSION_RUNS {
            let overdue = Instant::now().saturating_duration_since(since) > FUSION_LIMIT;
            return if status == SYSTEM_ERROR || overdue {
                Err(Lost::Fault(Fault::Silent))
            } else {
                Ok(None)
            };
        }
        let counts = [[xl, xh], [yl, yh], [zl, zh]].map(i16::from_le_bytes);
        // The chip's gravity has the sense of its accelerometer: up when level. The port wants down.
        let gravity = Vec3::from(counts.map(|c| f32::from(c) * (-1.0 / COUNTS_PER_UNIT)));
        if !LENGTH_SQUARED.contains(&gravity.norm_squared()) {
            return Err(Lost::Fault(Fault::Garbled));
        }
        if self.calibration.gyro < self.config.gyro_calibration_min {
            self.state = State::Running(Instant::now());
            return Ok(None);
        }
        Ok(Some(self.config.mounting.to_body(gravity)))
    }

    /// Gives the chip up for a pause.
    fn lose(&mut self, lost: Lost) {
        let fault = lost.fault();
        if self.last_fault != Some(fault) {
            report("BNO055", &fault);
        }
        self.last_fault = Some(fault);
        self.calibration = Calibration::default();
        let [_, longest] = PAUSE;
        self.state = State::Absent(Instant::now() + self.pause);
        self.pause = (self.pause * 2).min(longest);
    }

    async fn read<const N: usize>(&self, bus: &mut impl I2c, register: u8) -> Result<[u8; N], Lost> {
        let mut bytes = [0; N];
        bounded(bus.write_read(self.address as u8, &[register], &mut bytes)).await?;
        Ok(bytes)
    }

    async fn write(&self, bus: &mut impl I2c, register: u8, value: u8) -> Result<(), Lost> {
        bounded(bus.write(self.address as u8, &[register, value])).await
    }
}

/// Why a step failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lost {
    /// The transaction was not over in time: the clock is held, or the bus hangs.
    Timeout,
    /// I2C error, usually a NACK on the address.
    Refused,
    /// The chip answered wrongly.
    Fault(Fault),
}

impl Lost {
    const fn fault(self) -> Fault {
        match self {
            Self::Timeout => Fault::Silent,
            Self::Refused => Fault::Bus,
            Self::Fault(fault) => fault,
        }
    }

    const fn port_error(self) -> PortError {
        match self {
            Self::Timeout => PortError::Timeout,
            Self::Refused => PortError::Absent,
            Self::Fault(fault) => fault.port_error(),
        }
    }
}

/// A bus transaction that takes no longer than [`TRANSACTION`].
async fn bounded<T, E>(transaction: impl Future<Output = Result<T, E>>) -> Result<T, Lost> {
    match with_timeout(TRANSACTION, transaction).await {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(_)) => Err(Lost::Refused),
        Err(_) => Err(Lost::Timeout),
    }
}
