//! The simulated vehicle: plant, sensors, virtual clock, simulated board, pilot, scenarios and their flights.

pub mod aim;
pub mod arm_bench;
pub mod board;
pub mod check;
pub mod crsf;
pub mod flight;
pub mod flight_level;
pub mod live;
pub mod parallel;
pub mod pilot;
pub mod plant;
pub mod record;
pub mod sbus;
pub mod scenario;
pub mod sensors;
pub mod streams;

pub use sophie_clock as clock;
pub use sophie_mixers as mixers;
