//! Research with the flight stack: the paper's results, fits to test-stand measurements, and studies of many flights.

pub mod fit_report;
pub mod paper;
pub mod results;
pub mod study;
