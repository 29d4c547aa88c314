//! Experiments outside of missions: setpoints straight into the control loops, and the plant's response to a small
//! change of thrust.
//!
//! Tasks, laws and plant are those that fly; pilot and commander are left out.

pub mod allocation;
pub mod perturbation;
pub mod rig;
pub mod touch;
