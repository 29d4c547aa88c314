//! Stored parameters: checked at start-up, saved while the motors stand, shared by console and MAVLink.

pub mod parameters;
pub mod storing;
