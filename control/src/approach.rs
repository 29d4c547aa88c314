//! The way onto the pipe and off it: where the pipe is, and the velocities towards it.

pub(crate) mod limits;
pub mod pipe_target;
pub mod planner;
pub(crate) mod range_edges;
