//! The approach to the pipe: place of the pipe, range edges, and the planner of velocities.

pub(crate) mod limits;
pub(crate) mod pipe_edges;
pub mod pipe_target;
pub mod planner;
