//! What stands in for SOPHIE's hardware: the plant, the virtual clock, the simulated board and the pilot.

pub mod aim;
pub mod board;
pub mod crsf;
pub mod flight;
pub mod pilot;
pub mod plant;
pub mod record;
pub mod sbus;
pub mod scenario;
pub mod sensors;
pub mod study;

pub use sophie_clock as clock;
