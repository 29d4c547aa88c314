//! Watches the tasks and sensors, and retains the state for the next run.

pub mod retained_store;
pub mod silence;
pub mod supervisor;
