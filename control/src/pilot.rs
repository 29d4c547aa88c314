//! Inputs of people: receiver channels, stick positions, orders of a ground station, tests of actuators.

pub mod actuator_test;
pub mod rc;
pub mod release_throttle;
pub mod remote;
pub mod static_thrust_test;
pub mod stick_positions;
