//! Common to every Cortex-M board: interrupt levels, stack, caches, restarts, and memory that outlives a run.

#[cfg(not(family = "f4"))]
mod cache;
mod copy;
pub mod end;
mod fault;
pub mod image;
mod levels;
pub mod restart;
pub mod retained;
pub mod stack;
#[cfg(feature = "trace")]
pub mod trace;

#[cfg(not(family = "f4"))]
pub use cache::{enable_caches, enabled as caches, forget_cached, protected};
pub(crate) use levels::levels_on;
pub use levels::{BELOW_FLIGHT, FLIGHT, STEADY};

defmt::timestamp!("{=u64:us}", super::stm32::micros());
