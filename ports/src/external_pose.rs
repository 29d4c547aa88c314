//! Pose of the vehicle measured externally: by cameras aboard or around it.

use sophie_control::maths::vector::{Quat, Vec3};

/// External pose, converted to the vehicle's axes: the world is NED, or rotated from it about down; the body is FRD.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// Position in the world, m.
    pub position: Vec3,
    /// Rotation from body to world.
    pub attitude: Option<Quat>,
    /// Velocity in the world, m/s.
    pub velocity: Option<Vec3>,
    /// Variances along the world's axes, m².
    pub position_variance: Option<Vec3>,
    /// Variances of roll, pitch and yaw, rad².
    pub attitude_variance: Option<Vec3>,
    /// Variances along the world's axes, (m/s)².
    pub velocity_variance: Option<Vec3>,
    /// The world's x axis points north; otherwise it has the direction in which the sender started.
    pub north: bool,
    /// Reset counter: number of jumps of the sender's estimate.
    pub resets: u8,
    /// From 1 (worst) to 100 (best).
    pub quality: Option<u8>,
}

/// A pose with its times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExternalPose {
    /// The pose.
    pub pose: Pose,
    /// Time of measurement, µs since the start.
    pub measured_at: u64,
    /// Time of receipt, µs since the start.
    pub received_at: u64,
    /// Source of the time of measurement.
    pub clock: TimeSource,
}

/// Source of a time of measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeSource {
    /// The time of receipt: the message has no time, or the offset of the sender's clock is unknown.
    #[default]
    Receipt,
    /// The sender uses the vehicle's clock.
    Vehicle,
    /// The sender's clock, corrected by its offset.
    Offset,
}
