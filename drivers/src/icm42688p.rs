//! TDK ICM-42688-P on SPI, up to 24 MHz, mode 0 or 3. Sections are those of DS-000347 rev. 1.8.
//!
//! The ICM-42688-V (DS-000439) is the same to it but for its identity: ArduPilot takes one for the other (pull request
//! 31199, tried on a board with a V).
//!
//! Samples at 1, 2, 4 (default) or 8 kHz, one burst per data-ready pulse, with wide filters: the imu task filters. From
//! 2 kHz the rate fixes the UI filter's bandwidth (§5.5: 1048 Hz at 4 kHz); only its order can be chosen.

use embassy_time::Duration;
use sophie_control::params::{ImuAccelRange, ImuGyroRange, ImuRate, Params};

use crate::registers::Setting;
use crate::self_test::{Limits, Stage};
use crate::spi_imu::{Chip, Raw, Settings, SpiImu, Watch};

/// ICM-42688-P on SPI device `S` with its INT1 on `D`.
pub type Icm42688p<S, D> = SpiImu<Config, S, D>;

mod reg {
    //! Addresses, §13. Bank 0 unless named otherwise.
    pub const DEVICE_CONFIG: u8 = 0x11;
    pub const INT_CONFIG: u8 = 0x14;
    pub const FIFO_CONFIG: u8 = 0x16;
    pub const TEMP_DATA1: u8 = 0x1D;
    pub const INT_STATUS: u8 = 0x2D;
    pub const INTF_CONFIG0: u8 = 0x4C;
    pub const INTF_CONFIG1: u8 = 0x4D;
    pub const PWR_MGMT0: u8 = 0x4E;
    pub const GYRO_CONFIG0: u8 = 0x4F;
    pub const ACCEL_CONFIG0: u8 = 0x50;
    pub const GYRO_CONFIG1: u8 = 0x51;
    pub const GYRO_ACCEL_CONFIG0: u8 = 0x52;
    pub const ACCEL_CONFIG1: u8 = 0x53;
    pub const INT_CONFIG1: u8 = 0x64;
    pub const INT_SOURCE0: u8 = 0x65;
    pub const SELF_TEST_CONFIG: u8 = 0x70;
    pub const WHO_AM_I: u8 = 0x75;
    pub const REG_BANK_SEL: u8 = 0x76;
    pub const B1_GYRO_CONFIG_STATIC2: u8 = 0x0B;
    pub const B1_GYRO_CONFIG_STATIC3: u8 = 0x0C;
    pub const B1_GYRO_CONFIG_STATIC4: u8 = 0x0D;
    pub const B1_GYRO_CONFIG_STATIC5: u8 = 0x0E;
    pub const B1_XG_ST_DATA: u8 = 0x5F;
    pub const B2_ACCEL_CONFIG_STATIC2: u8 = 0x03;
    pub const B2_ACCEL_CONFIG_STATIC3: u8 = 0x04;
    pub const B2_ACCEL_CONFIG_STATIC4: u8 = 0x05;
    pub const B2_XA_ST_DATA: u8 = 0x3B;
}

/// GYRO_FS_SEL (§14.37).
const fn gyro_code(range: ImuGyroRange) -> u8 {
    match range {
        ImuGyroRange::Dps2000 => 0,
        ImuGyroRange::Dps1000 => 1,
        ImuGyroRange::Dps500 => 2,
        ImuGyroRange::Dps250 => 3,
    }
}

/// ACCEL_FS_SEL (§14.38).
const fn accel_code(range: ImuAccelRange) -> u8 {
    match range {
        ImuAccelRange::G16 => 0,
        ImuAccelRange::G8 => 1,
        ImuAccelRange::G4 => 2,
        ImuAccelRange::G2 => 3,
    }
}

/// GYRO_ODR and ACCEL_ODR, which have the same codes (§14.37).
const fn rate_code(rate: ImuRate) -> u8 {
    match rate {
        ImuRate::Hz8000 => 3,
        ImuRate::Hz4000 => 4,
        ImuRate::Hz2000 => 5,
        ImuRate::Hz1000 => 6,
    }
}

/// UI filter order (§5.5).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum FilterOrder {
    /// First order: 0.4 ms of delay at 4 kHz.
    #[default]
    First = 0,
    /// Second order.
    Second = 1,
    /// Third order.
    Third = 2,
}

/// UI filter bandwidth at 1 kHz and below (§14.40).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum UiBandwidth {
    /// Half the rate.
    Half = 0,
    /// A quarter of the rate, the reset value.
    #[default]
    Quarter = 1,
    /// A fifth of the rate.
    Fifth = 2,
    /// An eighth of the rate.
    Eighth = 3,
    /// A tenth of the rate.
    Tenth = 4,
}

/// Anti-alias bandwidth, second order (§5.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AntiAlias {
    /// 213 Hz.
    Hz213,
    /// 258 Hz.
    Hz258,
    /// 394 Hz.
    Hz394,
    /// 585 Hz, the gyroscope's reset value.
    #[default]
    Hz585,
    /// 997 Hz.
    Hz997,
    /// 1962 Hz.
    Hz1962,
    /// No filter.
    Off,
}

impl AntiAlias {
    /// AAF_DELT, AAF_DELTSQR and AAF_BITSHIFT of the table in §5.3.
    const fn codes(self) -> (u8, u16, u8) {
        match self {
            Self::Hz213 => (5, 25, 10),
            Self::Hz258 => (6, 36, 10),
            Self::Hz394 => (9, 81, 9),
            Self::Hz585 | Self::Off => (13, 170, 8),
            Self::Hz997 => (21, 440, 6),
            Self::Hz1962 => (37, 1376, 4),
        }
    }
}

/// Configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Config {
    /// Gyroscope range.
    pub gyro_range: ImuGyroRange,
    /// Accelerometer range.
    pub accel_range: ImuAccelRange,
    /// Sample rate of both sensors.
    pub rate: ImuRate,
    /// Order of both UI filters.
    pub filter_order: FilterOrder,
    /// Bandwidth of both UI filters at 1 kHz.
    pub ui_bandwidth: UiBandwidth,
    /// Gyroscope anti-alias filter.
    pub gyro_anti_alias: AntiAlias,
    /// Accelerometer anti-alias filter.
    pub accel_anti_alias: AntiAlias,
    /// In-flight monitoring.
    pub watch: Watch,
}

impl Config {
    /// Rate and ranges of the parameters, defaults otherwise.
    pub fn from_params(p: &Params) -> Self {
        Self {
            rate: p.imu_rate,
            gyro_range: p.imu_gyro_range,
            accel_range: p.imu_accel_range,
            watch: Watch::at(p.imu_rate.number()),
            ..Self::default()
        }
    }
}

impl Default for Config {
    /// 2000 °/s, 16 g, 4 kHz, first-order filters.
    fn default() -> Self {
        Self {
            gyro_range: ImuGyroRange::Dps2000,
            accel_range: ImuAccelRange::G16,
            rate: ImuRate::Hz4000,
            filter_order: FilterOrder::default(),
            ui_bandwidth: UiBandwidth::default(),
            gyro_anti_alias: AntiAlias::default(),
            accel_anti_alias: AntiAlias::default(),
            watch: Watch::default(),
        }
    }
}

impl Chip for Config {
    const NAME: &'static str = "ICM-42688-P";
    const SPI_HZ: u32 = 24_000_000;
    const WHO_AM_I: u8 = reg::WHO_AM_I;
    const IDENTITY: u8 = 0x47;
    const ALIKE: &'static [(u8, &'static str)] = &[(0xDB, "ICM-42688-V")];
    const BANK_SELECT: Option<u8> = Some(reg::REG_BANK_SEL);
    // Temperature, accelerometer, gyroscope (§13.1).
    const DATA: u8 = reg::TEMP_DATA1;
    const WATCH_FROM: u8 = reg::PWR_MGMT0;
    // Set with each sample, cleared by reading: reset value of INT_CONFIG0 (§14.21, §14.49).
    const SAMPLE_READY: Setting = Setting::bits(0, reg::INT_STATUS, 0x08, 0x08);
    const LINE: &'static [u8] = &[reg::INT_CONFIG, reg::INT_CONFIG1, reg::INT_SOURCE0];
    const RESET: &'static [Setting] = &[Setting::all(reg::DEVICE_CONFIG, 0x01)];
    // 1 ms (§14.1), doubled.
    const RESET_TIME: Duration = Duration::from_millis(2);
    // Both sensors off.
    const AFTER_RESET: Setting = Setting::all(reg::PWR_MGMT0, 0x00);
    const WAKE: &'static [Setting] = &[];
    const WAKE_TIME: Duration = Duration::from_ticks(0);
    // Both in low-noise mode, temperature sensor on (§14.36).
    const POWER: Setting = Setting::bits(0, reg::PWR_MGMT0, 0x2F, 0x0F);
    // The gyroscope starts in 30 ms and must stay on for 45 ms (§3.1, §14.36).
    const START_UP: Duration = Duration::from_millis(45);
    const GYRO_CODES: (u8, u8) = (1, reg::B1_XG_ST_DATA);
    const ACCEL_CODES: (u8, u8) = (2, reg::B2_XA_ST_DATA);
    const SELF_TEST: Limits = Limits {
        gyro_ratio_max: 1.5,
        accel_ratio_max: 1.5,
        gyro_min_dps: 60.0,
        accel_g: [0.05, 1.2],
        gyro_offset_dps: 20.0,
    };

    fn settings(&self) -> Settings {
        let order = self.filter_order as u8;
        let bandwidth = self.ui_bandwidth as u8;
        let rate = rate_code(self.rate);
        let (gyro_delt, gyro_square, gyro_shift) = self.gyro_anti_alias.codes();
        let (accel_delt, accel_square, accel_shift) = self.accel_anti_alias.codes();
        let [gyro_square_high, gyro_square_low] = gyro_square.to_be_bytes();
        let [accel_square_high, accel_square_low] = accel_square.to_be_bytes();
        let gyro_off = u8::from(self.gyro_anti_alias == AntiAlias::Off) << 1;
        let accel_off = u8::from(self.accel_anti_alias == AntiAlias::Off);
        // Only range and rate may change while the sensors are on (§12.9).
        Settings::from_array([
            // INT1 pulsed, push-pull, active high.
            Setting::bits(0, reg::INT_CONFIG, 0x07, 0x03),
            // No FIFO.
            Setting::bits(0, reg::FIFO_CONFIG, 0xC0, 0x00),
            // Big-endian data, -32768 until the first sample, I2C off.
            Setting::bits(0, reg::INTF_CONFIG0, 0x93, 0x13),
            // Adaptive full scale off, a bit the datasheet reserves: with it on, the gyroscope's output sometimes
            // stalls for some 2 ms (ArduPilot pull request 25332; also off in Betaflight and INAV). PLL clock when
            // available.
            Setting::bits(0, reg::INTF_CONFIG1, 0xC3, 0x41),
            Setting::bits(0, reg::GYRO_CONFIG0, 0xEF, gyro_code(self.gyro_range) << 5 | rate),
            Setting::bits(
                0,
                reg::ACCEL_CONFIG0,
                0xEF,
                accel_code(self.accel_range) << 5 | rate,
            ),
            Setting::bits(0, reg::GYRO_CONFIG1, 0x0C, order << 2),
            Setting::all(reg::GYRO_ACCEL_CONFIG0, bandwidth << 4 | bandwidth),
            Setting::bits(0, reg::ACCEL_CONFIG1, 0x18, order << 3),
            // Pulses of 8 µs without a pause, needed from 4 kHz (§14.50); INT_ASYNC_RESET off (§12.6).
            Setting::bits(0, reg::INT_CONFIG1, 0x70, 0x60),
            // Only data-ready on INT1.
            Setting::bits(0, reg::INT_SOURCE0, 0x7F, 0x08),
            // Gyroscope: factory notch on, anti-alias filter.
            Setting::bits(1, reg::B1_GYRO_CONFIG_STATIC2, 0x03, gyro_off),
            Setting::bits(1, reg::B1_GYRO_CONFIG_STATIC3, 0x3F, gyro_delt),
            Setting::bits(1, reg::B1_GYRO_CONFIG_STATIC4, 0xFF, gyro_square_low),
            Setting::bits(
                1,
                reg::B1_GYRO_CONFIG_STATIC5,
                0xFF,
                gyro_shift << 4 | gyro_square_high,
            ),
            // Accelerometer: anti-alias filter.
            Setting::bits(2, reg::B2_ACCEL_CONFIG_STATIC2, 0x7F, accel_delt << 1 | accel_off),
            Setting::bits(2, reg::B2_ACCEL_CONFIG_STATIC3, 0xFF, accel_square_low),
            Setting::bits(
                2,
                reg::B2_ACCEL_CONFIG_STATIC4,
                0xFF,
                accel_shift << 4 | accel_square_high,
            ),
        ])
    }

    fn self_test_settings(stage: Stage) -> Settings {
        let actuate = |axes| Setting::bits(0, reg::SELF_TEST_CONFIG, 0x7F, axes);
        match stage {
            // 250 °/s and 2 g at 1 kHz, third order, a tenth of the rate: the maker's choice. Filters may only change
            // with the sensors off (§12.9).
            Stage::Rest => Settings::from_array([
                Setting::bits(0, reg::PWR_MGMT0, 0x2F, 0x00),
                Setting::bits(0, reg::GYRO_CONFIG0, 0xEF, 3 << 5 | rate_code(ImuRate::Hz1000)),
                Setting::bits(0, reg::ACCEL_CONFIG0, 0xEF, 3 << 5 | rate_code(ImuRate::Hz1000)),
                Setting::bits(0, reg::GYRO_CONFIG1, 0x0C, 2 << 2),
                Setting::bits(0, reg::ACCEL_CONFIG1, 0x18, 2 << 3),
                Setting::all(reg::GYRO_ACCEL_CONFIG0, 0x44),
                actuate(0x00),
                Self::POWER,
            ]),
            Stage::Gyro => Settings::from_array([actuate(0x07)]),
            // The accelerometer's actuation has its own supply, bit 6.
            Stage::Accel => Settings::from_array([actuate(0x78)]),
        }
    }

    fn self_test_time(stage: Stage) -> Duration {
        match stage {
            Stage::Rest => Duration::from_millis(60),
            Stage::Gyro => Duration::from_millis(200),
            Stage::Accel => Duration::from_millis(50),
        }
    }

    fn arrange([temperature, ax, ay, az, gx, gy, gz]: [i16; 7]) -> Raw {
        Raw {
            accel: [ax, ay, az],
            gyro: [gx, gy, gz],
            temperature,
        }
    }

    fn celsius(raw: i16) -> f32 {
        // §4.13.
        f32::from(raw) * (1.0 / 132.48) + 25.0
    }

    fn pulses_per_sample(&self) -> u8 {
        1
    }

    fn rate_hz(&self) -> f32 {
        self.rate.number()
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
