//! The judgement whether an arm holds the pipe, and whether it is free of it.

/// What is known of one arm's grip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmGrip {
    /// State of the arm.
    pub state: ArmState,
    /// Contact pressure, Pa.
    pub pressure: f32,
    /// Tendon force, N.
    pub force: f32,
    /// Time from the start of closing until the pressure was within its tolerance for good, s.
    pub closure: Option<f32>,
}

/// State of one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ArmState {
    /// Tendon slack, no pressure.
    #[default]
    Free,
    /// Tendon winding, no contact yet.
    Closing,
    /// Pressure rising.
    Touching,
    /// Pressure held within its tolerance for the dwell time, force below the limit.
    Holding,
    /// The force limit was reached before the pressure.
    ForceLimited,
    /// The sensor or the arm's own IMU failed: force is held.
    Faulty,
    /// Tendon paying out.
    Releasing,
}
