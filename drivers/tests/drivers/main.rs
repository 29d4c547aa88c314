//! Each driver on fake chips, in virtual time.

mod barometer;
mod bno055;
mod data_ready;
mod fake;
mod fram;
mod i2c_lines;
mod icm20689;
mod icm42688p;
mod param_store;
mod recordings;
