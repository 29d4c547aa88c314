//! Inputs of people: receiver channels, stick positions, orders of a ground station and of the bench.

pub mod bench_orders;
pub mod rc;
pub mod release_throttle;
pub mod remote;
pub mod stick_positions;
