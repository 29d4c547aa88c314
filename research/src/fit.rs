//! Fits of Eq. 1 and of the tendon to measurements of an arm on a test stand (`sophie fit-arm`).

pub mod arm;
pub mod arm_data;
mod csv;
mod least_squares;
pub mod report;
pub mod tendon;
pub mod tendon_data;
