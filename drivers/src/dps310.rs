//! Infineon DPS310 on I2C: pressure and temperature. Sections are those of its datasheet, v1.2.
//!
//! Measures on command, pressure over 8 samples, temperature over 4 with each eighth pressure: 0.4 Pa of noise in 15 ms
//! (table 16), no shift of the result (§8.6), and the chip rests in between. Goertek's SPL06-001 has the same registers and
//! identity.

use embassy_time::{Duration, Instant, Timer, with_timeout};
use embedded_hal_async::i2c::I2c;

use crate::barometer::{Barometer, Chip};
use crate::fault::Fault;

/// Address with SDO low, as on the Matek H743 (§5.1: 0x77 with SDO high or open).
pub const ADDRESS: u8 = 0x76;
/// Product and revision (§8.11).
pub const IDENTITY: u8 = 0x10;

/// A DPS310 on bus `B`.
pub type Dps310<B> = Barometer<Part<B>>;

/// Time limit of a transaction, with the turn of an arm sensor on the bus before it, 6 ms; the longest, 20 bytes, takes
/// 0.5 ms at 400 kHz, 1.8 ms at 100 kHz.
const TRANSACTION: Duration = Duration::from_millis(8);
/// Measurement times (table 16): 14.8 ms over 8 samples, 8.4 ms over 4.
const PRESSURE_TIME: Duration = Duration::from_micros(14_800);
const TEMPERATURE_TIME: Duration = Duration::from_micros(8_400);
/// Looks at the status after that, and the time between two: the chip's clock is a few percent off.
const LOOKS: u8 = 4;
const LOOK_TIME: Duration = Duration::from_millis(1);
/// Pressures between two temperatures: the part warms by less than 0.1 °C, 1 Pa, in 0.3 s.
const TEMPERATURE_EACH: u8 = 8;

mod reg {
    //! §7.
    pub const PSR_B2: u8 = 0x00;
    pub const TMP_B2: u8 = 0x03;
    pub const PRS_CFG: u8 = 0x06;
    pub const TMP_CFG: u8 = 0x07;
    pub const MEAS_CFG: u8 = 0x08;
    pub const CFG_REG: u8 = 0x09;
    pub const RESET: u8 = 0x0C;
    pub const PRODUCT_ID: u8 = 0x0D;
    pub const COEF: u8 = 0x10;
    pub const COEF_SRCE: u8 = 0x28;
}

/// Status bits of MEAS_CFG (§8.5).
const COEF_RDY: u8 = 0x80;
const SENSOR_RDY: u8 = 0x40;
const TMP_RDY: u8 = 0x20;
const PRS_RDY: u8 = 0x10;
/// Commands in its low bits.
const MEASURE_PRESSURE: u8 = 0x01;
const MEASURE_TEMPERATURE: u8 = 0x02;
const SOFT_RESET: u8 = 0x09;
/// Oversampling code, and scale factor of its results (§4.9.3, table 9).
const OVER_8: u8 = 0x03;
const SCALE_8: f32 = 7_864_320.0;
const OVER_4: u8 = 0x02;
const SCALE_4: f32 = 3_670_016.0;
/// Bit 7 of TMP_CFG and of COEF_SRCE: the sensor in the pressure element, for which the coefficients are.
const EXTERNAL: u8 = 0x80;
/// Some parts read 60 °C or so at room temperature, of a fuse: Infineon's own driver writes these (`correctTemp`), as do
/// Betaflight's, PX4's and ArduPilot's.
const FUSE: [(u8, u8); 5] = [
    (0x0E, 0xA5),
    (0x0F, 0x96),
    (0x62, 0x02),
    (0x0E, 0x00),
    (0x0F, 0x00),
];

/// Calibration of one part (§8.12).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficients {
    temperature: [f32; 2],
    /// c00, c10, c20, c30.
    pressure: [f32; 4],
    /// c01, c11, c21.
    cross: [f32; 3],
}

impl Coefficients {
    /// Of the registers 0x10 to 0x21.
    pub fn of(bytes: [u8; 18]) -> Self {
        let [b0, b1, b2, b3, b4, b5, b6, b7, rest @ ..] = bytes;
        let [c01h, c01l, c11h, c11l, c20h, c20l, c21h, c21l, c30h, c30l] = rest;
        let wide = |high: u8, low: u8| f32::from(i16::from_be_bytes([high, low]));
        let [b0, b1, b2, b3, b4, b5, b6, b7] = [b0, b1, b2, b3, b4, b5, b6, b7].map(i32::from);
        Self {
            temperature: [
                signed::<12>(b0 << 4 | b1 >> 4),
                signed::<12>((b1 & 0xF) << 8 | b2),
            ],
            pressure: [
                signed::<20>(b3 << 12 | b4 << 4 | b5 >> 4),
                signed::<20>((b5 & 0xF) << 16 | b6 << 8 | b7),
                wide(c20h, c20l),
                wide(c30h, c30l),
            ],
            cross: [wide(c01h, c01l), wide(c11h, c11l), wide(c21h, c21l)],
        }
    }

    /// Pressure, Pa, of scaled raw values (§4.9.1).
    fn pascal(&self, p: f32, t: f32) -> f32 {
        let [c00, c10, c20, c30] = self.pressure;
        let [c01, c11, c21] = self.cross;
        c00 + p * (c10 + p * (c20 + p * c30)) + t * c01 + t * p * (c11 + p * c21)
    }

    /// Temperature, °C, of a scaled raw value (§4.9.2).
    fn celsius(&self, t: f32) -> f32 {
        let [c0, c1] = self.temperature;
        0.5 * c0 + c1 * t
    }

    /// Pressure, Pa, and temperature, °C, of what the registers held: pressure over 8 samples, temperature over 4.
    pub fn convert(&self, pressure: [u8; 3], temperature: [u8; 3]) -> (f32, f32) {
        let t = raw(temperature) / SCALE_4;
        (self.pascal(raw(pressure) / SCALE_8, t), self.celsius(t))
    }
}

/// A two's complement of 24 bits.
fn raw([high, middle, low]: [u8; 3]) -> f32 {
    signed::<24>(i32::from_be_bytes([0, high, middle, low]))
}

/// A two's complement of `BITS` bits.
fn signed<const BITS: u32>(value: i32) -> f32 {
    (value << (32 - BITS) >> (32 - BITS)) as f32
}

/// The chip.
pub struct Part<B> {
    bus: B,
    coefficients: Coefficients,
    temperature: [u8; 3],
    /// Pressures until the next temperature.
    until: u8,
}

impl<B: I2c> Barometer<Part<B>> {
    /// The one at [`ADDRESS`] on `bus`, without access until the first measurement.
    pub const fn at(bus: B) -> Self {
        Self::new(Part {
            bus,
            coefficients: Coefficients {
                temperature: [0.0; 2],
                pressure: [0.0; 4],
                cross: [0.0; 3],
            },
            temperature: [0; 3],
            until: 0,
        })
    }
}

impl<B: I2c> Part<B> {
    async fn read<const N: usize>(&mut self, register: u8) -> Result<[u8; N], Fault> {
        let (mut bytes, from) = ([0; N], [register]);
        let transfer = self.bus.write_read(ADDRESS, &from, &mut bytes);
        match with_timeout(TRANSACTION, transfer).await {
            Ok(Ok(())) => Ok(bytes),
            _ => Err(Fault::Bus),
        }
    }

    async fn write(&mut self, register: u8, value: u8) -> Result<(), Fault> {
        match with_timeout(TRANSACTION, self.bus.write(ADDRESS, &[register, value])).await {
            Ok(Ok(())) => Ok(()),
            _ => Err(Fault::Bus),
        }
    }

    async fn command(&mut self, what: u8, time: Duration, ready: u8) -> Result<(), Fault> {
        self.write(reg::MEAS_CFG, what).await?;
        Timer::after(time).await;
        for _ in 0..LOOKS {
            let [status] = self.read(reg::MEAS_CFG).await?;
            if status & ready != 0 {
                return Ok(());
            }
            Timer::after(LOOK_TIME).await;
        }
        Err(Fault::Silent)
    }

    async fn measure_temperature(&mut self) -> Result<(), Fault> {
        self.command(MEASURE_TEMPERATURE, TEMPERATURE_TIME, TMP_RDY)
            .await?;
        self.temperature = self.read(reg::TMP_B2).await?;
        self.until = TEMPERATURE_EACH;
        Ok(())
    }

    async fn configure(&mut self) -> Result<(), Fault> {
        for (register, value) in FUSE {
            self.write(register, value).await?;
        }
        let [source] = self.read(reg::COEF_SRCE).await?;
        let settings = [
            (reg::PRS_CFG, OVER_8),
            (reg::TMP_CFG, source & EXTERNAL | OVER_4),
            (reg::CFG_REG, 0),
        ];
        for (register, value) in settings {
            self.write(register, value).await?;
        }
        for (register, expected) in settings {
            let [found] = self.read(register).await?;
            if found != expected {
                return Err(Fault::Configuration {
                    bank: 0,
                    register,
                    expected,
                    found,
                });
            }
        }
        Ok(())
    }
}

impl<B: I2c> Chip for Part<B> {
    const NAME: &'static str = "DPS310";

    // To readable coefficients 40 ms (§6), with margin.
    const RESET_TIME: Duration = Duration::from_millis(50);

    async fn reset(&mut self) -> Result<(), Fault> {
        let [found] = self.read(reg::PRODUCT_ID).await?;
        if found != IDENTITY {
            return Err(Fault::Identity {
                expected: IDENTITY,
                found,
            });
        }
        // Refused by a part that resets at once: status and settings read back after it decide.
        let _ = self.write(reg::RESET, SOFT_RESET).await;
        Ok(())
    }

    async fn set_up(&mut self) -> Result<(), Fault> {
        let [status] = self.read(reg::MEAS_CFG).await?;
        if status & (COEF_RDY | SENSOR_RDY) != COEF_RDY | SENSOR_RDY {
            return Err(Fault::Reset {
                register: reg::MEAS_CFG,
                found: status,
            });
        }
        self.coefficients = Coefficients::of(self.read(reg::COEF).await?);
        self.configure().await?;
        // The first after the fuse's correction is still of before it.
        self.measure_temperature().await?;
        self.until = 0;
        Ok(())
    }

    async fn measure(&mut self) -> Result<(Instant, f32, f32), Fault> {
        if self.until == 0 {
            self.measure_temperature().await?;
        }
        let middle = Instant::now() + PRESSURE_TIME / 2;
        self.command(MEASURE_PRESSURE, PRESSURE_TIME, PRS_RDY).await?;
        let pressure = self.read(reg::PSR_B2).await?;
        self.until = self.until.saturating_sub(1);
        let (pascal, celsius) = self.coefficients.convert(pressure, self.temperature);
        Ok((middle, pascal, celsius))
    }
}
