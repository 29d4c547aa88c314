//! Experiments outside missions: setpoints straight into the control loops, and the plant's response to a small change
//! of thrust. Tasks, laws and plant are those that fly.

pub mod allocation;
pub mod capture;
pub mod cause;
pub mod half_hour;
pub mod perturbation;
pub mod rig;
pub mod touch;
pub mod unknown;
pub mod vehicles;
