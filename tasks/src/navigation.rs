//! Position and its sensors: flow and range, barometer, estimate.

pub mod barometer;
pub(crate) mod flow_limit;
pub mod flow_range;
pub mod position;
