//! Parts that several modes use.

pub mod collective;
pub mod descent;
pub mod ground_probe;
pub mod landing_point;
pub mod on_pipe;
pub mod power_up_grip;
