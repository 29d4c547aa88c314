//! Watches the tasks and sensors, and retains the state for the next run.

pub mod chip_rows;
pub mod retained_store;
pub mod self_test;
pub mod silence;
pub mod supervisor;
