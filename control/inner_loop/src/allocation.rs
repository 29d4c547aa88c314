//! Control allocation: thrust and moments to the four rotors along arms that bend.

pub mod arm_deflection;
pub mod arm_tilt;
pub mod desaturation;
pub mod effectiveness;
pub mod least_thrust;
pub mod mixer;
pub mod motor_map;
pub mod motor_pulses;
pub mod thrust_curve;
pub mod wrench;
