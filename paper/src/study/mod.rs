//! Experiments on the vehicle that no mission contains: setpoints straight into the control loops, and the plant's own
//! answer to a small change of thrust.
//!
//! They use the tasks, laws and plant that fly; only pilot and commander are left out.

pub mod allocation;
pub mod perturbation;
pub mod rig;
pub mod touch;
