//! Drivers of sensors, and wire formats of receiver and actuators.
//!
//! Chips are reached through embedded-hal traits, timers through counts for compare registers. A board builds the
//! drivers and gives them to the tasks as ports.
//!
//! | module | part or protocol | port |
//! |---|---|---|
//! | [`icm42688p`], [`icm20689`] over [`spi_imu`] | vehicle's inertial sensor, SPI | `Imu` |
//! | [`line_watch`] | silent data-ready line | used by [`spi_imu`] |
//! | [`bno055`], [`arm_buses`] | arms' inertial sensors, I2C | `ArmImus` |
//! | [`dps310`], [`ms5611`] over [`barometer`] | barometer, I2C or SPI | `Barometer` |
//! | [`i2c_lines`] | held I2C bus | used by the board's buses |
//! | [`esc_protocol`]: [`dshot`], [`dshot_decoder`], [`esc_pwm`] | motor controllers | used by the board's `Motors` |
//! | [`rc_decoder`]: [`crsf`], [`sbus`] | receiver | `RcDecoder` |
//! | [`ground_module`]: [`msp`] | flow and range | `GroundDecoder` |
//! | [`servo_pulse`] | tendon servos | used by the board's `Servos` |
//! | [`param_store`], [`fram`] | parameters in flash, or in FRAM on SPI | `Storage` |

#![no_std]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp
)]
#![allow(
    async_fn_in_trait,
    reason = "drivers are awaited in place; no caller needs a Send bound"
)]

pub mod arm_buses;
pub mod barometer;
pub mod bno055;
pub mod crsf;
pub mod dps310;
pub mod dshot;
pub mod dshot_decoder;
pub mod esc_protocol;
pub mod esc_pwm;
pub mod fault;
pub mod fram;
pub mod ground_module;
pub mod i2c_lines;
pub mod i2c_timing;
pub mod icm20689;
pub mod icm42688p;
pub mod line_watch;
pub mod mounting;
pub mod ms5611;
pub mod msp;
pub mod param_store;
pub mod pwm_timing;
pub mod rc_decoder;
pub mod registers;
pub mod sbus;
pub mod self_test;
pub mod servo_pulse;
pub mod spi_clock;
pub mod spi_imu;
