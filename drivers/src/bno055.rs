//! Bosch BNO055 on I2C: the fused gravity vector at an arm's tip. Sections are those of BST-BNO055-DS000 rev. 1.4.
//!
//! The chip takes 650 ms from reset, 19 ms into and 7 ms out of configuration mode, stretches the clock and may reset
//! itself. A call therefore does one step of a few time-limited accesses and returns [`PortError::Absent`] until the
//! chip is ready. Failures cause a pause, doubling up to 1 s.

use embassy_time::{Duration, Instant, with_timeout};
use embedded_hal_async::i2c::I2c;
use sophie_control::maths::vector::Vec3;
use sophie_ports::error::PortError;

use crate::fault::{Fault, report};
use crate::mounting::Mounting;

/// Time limit of a transaction. The longest, 19 bytes, takes 0.43 ms at 400 kHz and 2.0 ms at the slowest bus, 87.5 kHz;
/// chips have been seen to hold the clock for 180 µs after each byte (Bosch's forum: "Minimum I2C communication interval";
/// 26 registers in up to 6 ms: kriswiner/BNO055 issue 4), which adds 3.4 ms.
pub const TRANSACTION: Duration = Duration::from_millis(6);
/// Reset until registers are writable (§1.2: 650 ms), with margin.
const RESET_TIME: Duration = Duration::from_millis(700);
/// Any mode to configuration mode (§3.3, table 3-6).
const TO_CONFIG: Duration = Duration::from_millis(19);
/// Configuration mode to any other (§3.3, table 3-6), and the first fused sample at 100 Hz.
const FROM_CONFIG: Duration = Duration::from_millis(7 + 10);
/// First and longest pause after a failure.
const PAUSE: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(1)];
const FAILURES_MAX: u8 = 3;
/// Time limit for the fusion to start or to recover.
const FUSION_LIMIT: Duration = Duration::from_secs(2);

/// Counts per m/s² of the gravity vector (§3.6.5.7).
const COUNTS_PER_UNIT: f32 = 100.0;
/// Plausible squared length of the gravity vector, (m/s²)²; the fusion scales it to 9.8.
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

/// Content of the chip id register (§4.3.1).
pub const CHIP_ID: u8 = 0xA0;
/// The other register page.
const OTHER_PAGE: u8 = 1;
const RST_SYS: u8 = 0x20;
/// m/s², °/s, degrees, °C; Android's pitch sense, the reset value.
const UNITS: u8 = 0x80;
const FUSION_RUNS: u8 = 5;
const SYSTEM_ERROR: u8 = 1;
const CONFIG_MODE: u8 = 0x00;
/// Identity axis map (§3.4); [`Mounting`] rotates instead.
const AXES: [u8; 2] = [0x24, 0x00];

/// I2C address, chosen by the pin COM3 (§4.6).
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
    /// Without a compass, which the motor's magnets would disturb.
    #[default]
    ImuPlus = 0x08,
    /// With the magnetometer.
    Ndof = 0x0C,
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Fusion mode.
    pub fusion: Fusion,
    /// Orientation of the chip on the straight arm, in body axes.
    pub mounting: Mounting,
    /// Least gyroscope calibration, 0 (none) to 3 (full), of a valid reading.
    pub gyro_calibration_min: u8,
}

impl Default for Config {
    /// Accelerometer and gyroscope, marking up, x forward, gyroscope calibration begun.
    fn default() -> Self {
        Self {
            fusion: Fusion::default(),
            mounting: Mounting::default(),
            gyro_calibration_min: 1,
        }
    }
}

/// Calibration levels, 0 (none) to 3 (full) (§4.3.54).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Calibration {
    /// Whole fusion.
    pub system: u8,
    /// Gyroscope: calibrates in a few seconds at rest.
    pub gyro: u8,
    /// Accelerometer: needs six positions.
    pub accel: u8,
    /// Magnetometer: needs a figure of eight.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Identity is due.
    Absent(Instant),
    /// Configuration mode is reached, in which alone the chip takes a reset.
    Stopping(Instant),
    /// Reset ends.
    Resetting(Instant),
    /// Configuration mode is reached.
    Entering(Instant),
    /// Fusion mode is reached.
    Leaving(Instant),
    /// Time of the last good reading.
    Running(Instant),
}

/// One chip; each call borrows the bus, which two chips share.
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
    /// Without bus access until [`Bno055::gravity`].
    pub const fn new(address: Address, config: Config) -> Self {
        let [pause, _] = PAUSE;
        Self {
            address,
            config,
            // The chip is powered with the processor and boots first.
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

    /// Last fault since power-up.
    pub const fn last_fault(&self) -> Option<Fault> {
        self.last_fault
    }

    /// True while readings arrive.
    pub const fn is_running(&self) -> bool {
        matches!(self.state, State::Running(_))
    }

    /// Advances the chip one step, or reads gravity in the axes of its mounting, m/s²; (0, 0, 9.8) when level.
    ///
    /// # Errors
    /// `Absent` while the chip is missing, not ready or not calibrated; `Timeout` and `Corrupt` for a failed reading.
    pub async fn gravity(&mut self, bus: &mut impl I2c) -> Result<Vec3, PortError> {
        let now = Instant::now();
        match self.state {
            State::Absent(at)
            | State::Stopping(at)
            | State::Resetting(at)
            | State::Entering(at)
            | State::Leaving(at)
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

    async fn advance(&mut self, bus: &mut impl I2c) -> Result<(), Lost> {
        self.state = match self.state {
            State::Absent(_) => {
                self.identify(bus).await?;
                self.enter_config(bus).await?;
                State::Stopping(Instant::now() + TO_CONFIG)
            }
            State::Stopping(_) => {
                // Configured from the reset state, whatever its former settings. A chip that resets at once does not
                // acknowledge, or holds the clock: the identity after the reset decides.
                let _ = self.write(bus, reg::SYS_TRIGGER, RST_SYS).await;
                State::Resetting(Instant::now() + RESET_TIME)
            }
            State::Resetting(_) => {
                self.identify(bus).await?;
                self.enter_config(bus).await?;
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

    async fn enter_config(&self, bus: &mut impl I2c) -> Result<(), Lost> {
        self.write(bus, reg::PAGE_ID, 0).await?;
        self.write(bus, reg::OPR_MODE, CONFIG_MODE).await
    }

    async fn configure(&self, bus: &mut impl I2c) -> Result<(), Lost> {
        let [axes, signs] = AXES;
        let settings = [
            (reg::PWR_MODE, 0x00),
            (reg::UNIT_SEL, UNITS),
            (reg::AXIS_MAP_CONFIG, axes),
            (reg::AXIS_MAP_SIGN, signs),
        ];
        // Internal clock, no self-test; write-only, so no read-back.
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

    /// Finds the chip on either page; writes only if the page is a BNO055's.
    async fn identify(&self, bus: &mut impl I2c) -> Result<(), Lost> {
        let [mut found] = self.read(bus, reg::CHIP_ID).await?;
        // After a processor-only reset or a bus glitch.
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
                // The chip does not return to its mode without a reset.
                let left = matches!(lost, Lost::Fault(Fault::Configuration { .. } | Fault::Silent));
                if left || self.failures >= FAILURES_MAX {
                    self.lose(lost);
                }
                Err(lost.port_error())
            }
        }
    }

    /// Evaluates a burst from GRV_DATA to OPR_MODE; `None` while the fusion starts or calibrates.
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
        // Detects a self-reset, which leaves the configuration mode.
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
        // The chip's gravity points up when level, the port's down.
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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lost {
    /// Held clock or hung bus.
    Timeout,
    /// I2C error, usually a NACK on the address.
    Refused,
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

async fn bounded<T, E>(transaction: impl Future<Output = Result<T, E>>) -> Result<T, Lost> {
    match with_timeout(TRANSACTION, transaction).await {
        Ok(Ok(value)) => Ok(value),
        Ok(Err(_)) => Err(Lost::Refused),
        Err(_) => Err(Lost::Timeout),
    }
}
