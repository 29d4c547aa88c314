//! What every Cortex-M board does the same way: levels, stack, the end of a run and what outlives it.

mod fault;
mod levels;
pub mod retained;
pub mod stack;

pub use levels::{FLIGHT, STEADY};
