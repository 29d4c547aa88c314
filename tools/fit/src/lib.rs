//! Numbers of a vehicle from measurements on a bench, with their 95 % intervals: linear least squares over tables that a
//! person has written (`sophie fit-arm`) or that `sophie bringup` has measured.

pub mod arm;
pub mod arm_data;
pub mod arm_table;
pub mod csv;
pub mod friction;
pub mod friction_data;
pub mod least_squares;
pub mod motor_lag;
pub mod rotor_sound;
pub mod servo_steps;
pub mod tendon;
pub mod tendon_data;
pub mod thrust;
pub mod thrust_data;
pub mod twist;
