//! The gripper: pressures and arm tilts in, tendon servos out.

pub mod analog;
pub mod arms;
pub mod clamp;
pub mod servos;
