//! TDK ICM-20689 on SPI, up to 8 MHz, mode 0 or 3. Register names and values are those of DS-000143.
//!
//! The gyroscope samples at 8 kHz behind its 250 Hz filter (0.97 ms delay); every second sample is read. Other rates
//! read another fraction: the part's own 1 kHz would delay by 2.9 ms. The accelerometer runs at 1 kHz, so its samples
//! repeat.

use embassy_time::Duration;
use sophie_control::params::{ImuAccelRange, ImuGyroRange, ImuRate, Params};

use crate::registers::Setting;
use crate::self_test::{Limits, Stage};
use crate::spi_imu::{Chip, Raw, Settings, SpiImu, Watch};

/// ICM-20689 on SPI device `S` with its INT on `D`.
pub type Icm20689<S, D> = SpiImu<Config, S, D>;

mod reg {
    pub const SELF_TEST_X_GYRO: u8 = 0x00;
    pub const SELF_TEST_X_ACCEL: u8 = 0x0D;
    pub const SMPLRT_DIV: u8 = 0x19;
    pub const CONFIG: u8 = 0x1A;
    pub const GYRO_CONFIG: u8 = 0x1B;
    pub const ACCEL_CONFIG: u8 = 0x1C;
    pub const ACCEL_CONFIG2: u8 = 0x1D;
    pub const FIFO_EN: u8 = 0x23;
    pub const INT_PIN_CFG: u8 = 0x37;
    pub const INT_ENABLE: u8 = 0x38;
    pub const INT_STATUS: u8 = 0x3A;
    pub const ACCEL_XOUT_H: u8 = 0x3B;
    pub const USER_CTRL: u8 = 0x6A;
    pub const PWR_MGMT_1: u8 = 0x6B;
    pub const PWR_MGMT_2: u8 = 0x6C;
    pub const WHO_AM_I: u8 = 0x75;
}

/// FS_SEL, GYRO_CONFIG bits 4:3.
const fn gyro_code(range: ImuGyroRange) -> u8 {
    match range {
        ImuGyroRange::Dps250 => 0,
        ImuGyroRange::Dps500 => 1,
        ImuGyroRange::Dps1000 => 2,
        ImuGyroRange::Dps2000 => 3,
    }
}

/// ACCEL_FS_SEL, ACCEL_CONFIG bits 4:3.
const fn accel_code(range: ImuAccelRange) -> u8 {
    match range {
        ImuAccelRange::G2 => 0,
        ImuAccelRange::G4 => 1,
        ImuAccelRange::G8 => 2,
        ImuAccelRange::G16 => 3,
    }
}

/// Gyroscope filter and rate: DLPF_CFG, CONFIG bits 2:0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum GyroFilter {
    /// 250 Hz, 0.97 ms delay, 8 kHz.
    #[default]
    Hz250 = 0,
    /// 176 Hz, 2.9 ms delay, 1 kHz.
    Hz176 = 1,
    /// 3281 Hz, 0.17 ms delay, 8 kHz.
    Hz3281 = 7,
}

/// Accelerometer filter, ACCEL_CONFIG2 bits 3:0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum AccelFilter {
    /// 218 Hz, 1 kHz.
    #[default]
    Hz218 = 0,
    /// 99 Hz, 1 kHz.
    Hz99 = 2,
    /// 1046 Hz, 4 kHz: bypassed.
    Hz1046 = 8,
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Gyroscope range.
    pub gyro_range: ImuGyroRange,
    /// Accelerometer range.
    pub accel_range: ImuAccelRange,
    /// Gyroscope filter and rate.
    pub gyro_filter: GyroFilter,
    /// Accelerometer filter.
    pub accel_filter: AccelFilter,
    /// Reads one sample in this many, 1 to 8.
    pub read_every: u8,
    /// In-flight monitoring.
    pub watch: Watch,
}

impl Config {
    /// Rate and ranges of the parameters, defaults otherwise.
    pub fn from_params(p: &Params) -> Self {
        let read_every = match p.imu_rate {
            ImuRate::Hz1000 => 8,
            ImuRate::Hz2000 => 4,
            ImuRate::Hz4000 => 2,
            ImuRate::Hz8000 => 1,
        };
        let config = Self {
            gyro_range: p.imu_gyro_range,
            accel_range: p.imu_accel_range,
            read_every,
            ..Self::default()
        };
        Self {
            watch: Watch::at(config.rate_hz()),
            ..config
        }
    }
}

impl Default for Config {
    /// 2000 °/s, 16 g, 250 Hz filter, read at 4 kHz.
    fn default() -> Self {
        Self {
            gyro_range: ImuGyroRange::Dps2000,
            accel_range: ImuAccelRange::G16,
            gyro_filter: GyroFilter::default(),
            accel_filter: AccelFilter::default(),
            read_every: 2,
            watch: Watch::default(),
        }
    }
}

impl Chip for Config {
    const NAME: &'static str = "ICM-20689";
    const SPI_HZ: u32 = 8_000_000;
    const WHO_AM_I: u8 = reg::WHO_AM_I;
    const IDENTITY: u8 = 0x98;
    const ALIKE: &'static [(u8, &'static str)] = &[];
    const BANK_SELECT: Option<u8> = None;
    // Accelerometer, temperature, gyroscope.
    const DATA: u8 = reg::ACCEL_XOUT_H;
    const WATCH_FROM: u8 = reg::SMPLRT_DIV;
    // Set with each sample, cleared by reading (INT_RD_CLEAR 0).
    const SAMPLE_READY: Setting = Setting::bits(0, reg::INT_STATUS, 0x01, 0x01);
    const LINE: &'static [u8] = &[reg::INT_PIN_CFG, reg::INT_ENABLE];
    const RESET: &'static [Setting] = &[Setting::all(reg::PWR_MGMT_1, 0x80)];
    // Up to 100 ms from power to register access; PX4 waits as long after a reset.
    const RESET_TIME: Duration = Duration::from_millis(100);
    // Asleep, reset bit gone.
    const AFTER_RESET: Setting = Setting::bits(0, reg::PWR_MGMT_1, 0xC0, 0x40);
    // Awake on the PLL; I2C off, signal paths reset.
    const WAKE: &'static [Setting] = &[
        Setting::all(reg::PWR_MGMT_1, 0x01),
        Setting::all(reg::USER_CTRL, 0x11),
    ];
    // The gyroscope starts in 35 ms at most.
    const WAKE_TIME: Duration = Duration::from_millis(40);
    // All six axes on.
    const POWER: Setting = Setting::all(reg::PWR_MGMT_2, 0x00);
    // Ten time constants of the slowest filter.
    const START_UP: Duration = Duration::from_millis(45);
    const GYRO_CODES: (u8, u8) = (0, reg::SELF_TEST_X_GYRO);
    const ACCEL_CODES: (u8, u8) = (0, reg::SELF_TEST_X_ACCEL);
    // AN-000029: no upper bound for the gyroscope's ratio.
    const SELF_TEST: Limits = Limits {
        gyro_ratio_max: f32::INFINITY,
        accel_ratio_max: 1.5,
        gyro_min_dps: 60.0,
        accel_g: [0.225, 0.675],
        gyro_offset_dps: 20.0,
    };

    fn settings(&self) -> Settings {
        Settings::from_array([
            // Used at 1 kHz only: every sample.
            Setting::all(reg::SMPLRT_DIV, 0x00),
            Setting::bits(0, reg::CONFIG, 0x87, self.gyro_filter as u8),
            // Self-test off, FCHOICE_B 0: filter in the path.
            Setting::bits(0, reg::GYRO_CONFIG, 0xFB, gyro_code(self.gyro_range) << 3),
            Setting::bits(0, reg::ACCEL_CONFIG, 0xF8, accel_code(self.accel_range) << 3),
            Setting::bits(0, reg::ACCEL_CONFIG2, 0x0F, self.accel_filter as u8),
            Setting::all(reg::FIFO_EN, 0x00),
            // Active high, push-pull, pulses of 50 µs.
            Setting::bits(0, reg::INT_PIN_CFG, 0xF0, 0x00),
            // Data-ready alone.
            Setting::all(reg::INT_ENABLE, 0x01),
            // I2C off.
            Setting::bits(0, reg::USER_CTRL, 0x10, 0x10),
            Setting::all(reg::PWR_MGMT_1, 0x01),
        ])
    }

    fn self_test_settings(stage: Stage) -> Settings {
        let all_axes = 0xE0;
        let (gyro, accel) = match stage {
            Stage::Rest => (0, 0),
            Stage::Gyro => (all_axes, 0),
            Stage::Accel => (0, all_axes),
        };
        Settings::from_array([
            // 1 kHz, 92 Hz and 99 Hz filters, 250 °/s, 2 g (AN-000029).
            Setting::bits(0, reg::CONFIG, 0x87, 2),
            Setting::bits(0, reg::ACCEL_CONFIG2, 0x0F, 2),
            Setting::bits(0, reg::GYRO_CONFIG, 0xFB, gyro),
            Setting::bits(0, reg::ACCEL_CONFIG, 0xF8, accel),
        ])
    }

    fn self_test_time(_stage: Stage) -> Duration {
        // AN-000029: 20 ms, doubled.
        Duration::from_millis(40)
    }

    fn arrange([ax, ay, az, temperature, gx, gy, gz]: [i16; 7]) -> Raw {
        Raw {
            accel: [ax, ay, az],
            gyro: [gx, gy, gz],
            temperature,
        }
    }

    fn celsius(raw: i16) -> f32 {
        f32::from(raw) * (1.0 / 326.8) + 25.0
    }

    fn pulses_per_sample(&self) -> u8 {
        self.read_every.clamp(1, 8)
    }

    fn rate_hz(&self) -> f32 {
        let sampled = match self.gyro_filter {
            GyroFilter::Hz250 | GyroFilter::Hz3281 => 8000.0,
            GyroFilter::Hz176 => 1000.0,
        };
        sampled / f32::from(self.pulses_per_sample())
    }

    fn gyro_range(&self) -> f32 {
        self.gyro_range.number()
    }

    fn accel_range(&self) -> f32 {
        self.accel_range.number()
    }

    fn watch(&self) -> Watch {
        self.watch
    }
}
