//! Pilot inputs: receiver channels, ground-station commands, bench orders.

pub mod bench_orders;
pub mod rc;
pub mod release_throttle;
pub mod remote;
pub mod stick_positions;
