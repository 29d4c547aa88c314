//! The pilot's side: receiver, mode logic, telemetry and its texts.

pub mod commander;
pub mod rc;
pub mod telemetry;
pub mod warning;
