//! The pose of the vehicle as others measure it: cameras aboard or around it.

use sophie_control::maths::vector::{Quat, Vec3};

/// What others see, in the vehicle's axes: the world is NED, or turned from it about down; the body is FRD.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pose {
    /// m.
    pub position: Vec3,
    /// From body to world.
    pub attitude: Option<Quat>,
    /// In the world, m/s.
    pub velocity: Option<Vec3>,
    /// Variances along the world's axes, m².
    pub position_variance: Option<Vec3>,
    /// Of roll, pitch and yaw, rad².
    pub attitude_variance: Option<Vec3>,
    /// Along the world's axes, (m/s)².
    pub velocity_variance: Option<Vec3>,
    /// The world's x is north; else it is where the sender's axes began.
    pub north: bool,
    /// Counts the jumps of the sender's estimate.
    pub resets: u8,
    /// 1 worst to 100 best.
    pub quality: Option<u8>,
}

/// A pose with its times.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExternalPose {
    /// The pose.
    pub pose: Pose,
    /// When it was measured, µs since the start.
    pub measured_at: u64,
    /// When it arrived, µs since the start.
    pub received_at: u64,
    /// How the time of measurement is known.
    pub clock: TimeSource,
}

/// How a time of measurement is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeSource {
    /// It is the time of receipt: the message has none, or nothing is known of the sender's clock.
    #[default]
    Receipt,
    /// The sender's clock is the vehicle's.
    Vehicle,
    /// By the sender's clock and its offset.
    Offset,
}
