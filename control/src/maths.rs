//! Vectors, filters, frames and small numeric helpers that know nothing of the vehicle.

pub mod decimal;
pub mod filter;
pub mod scalar;
pub mod vector;
