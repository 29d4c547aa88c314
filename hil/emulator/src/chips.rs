//! Chips on the processor's buses.

pub mod bno055;
pub mod dps310;
pub mod icm42688p;
pub mod line;
