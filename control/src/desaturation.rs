//! Placeholder replaced below.
/// Shares of a demand that the rotors could give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Share of the roll and pitch moments, 0..1.
    pub roll_pitch: f32,
    /// Thrust given less thrust asked, N.
    pub thrust_shift: f32,
    /// Share of the yaw moment, 0..1.
    pub yaw: f32,
}

impl Default for Given {
    fn default() -> Self {
        Self { roll_pitch: 1.0, thrust_shift: 0.0, yaw: 1.0 }
    }
}
