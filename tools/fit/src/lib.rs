//! Numbers of a vehicle from measurements on a bench, with their 95 % intervals: linear least squares over tables that a
//! person has written (`sophie fit-arm`) or that `sophie bringup` has measured.

pub mod arm;
pub mod arm_data;
pub mod csv;
pub mod friction;
pub mod friction_data;
pub mod least_squares;
pub mod tendon;
pub mod tendon_data;
