//! Parts that several states use.

pub mod coasting_hold;
pub mod collective;
pub mod descent;
pub mod ground_probe;
pub mod landing_point;
pub mod on_pipe;
pub mod power_up_grip;
pub mod stick_velocity;
