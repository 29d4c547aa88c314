//! Vectors, filters, frames, timers and numbers, independent of the vehicle.

pub mod decimal;
pub mod elapsed;
pub mod filter;
pub mod frames;
pub mod hold_timer;
pub mod scalar;
pub mod vector;
