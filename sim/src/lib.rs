//! The simulated vehicle: plant, sensors, virtual clock, simulated board, pilot, scenarios and their flights.

pub mod board;
pub mod check;
pub mod devices;
pub mod flight;
pub mod live;
pub mod normal;
pub mod parallel;
pub mod pilot;
pub mod plant;
pub mod record;
pub mod scenario;
pub mod sensors;
pub mod streams;
pub mod target_angles;
pub mod test_stands;

pub use sophie_clock as clock;
pub use sophie_mixers as mixers;
