//! Forces that the clamp asks of the tendons, and what they follow from.

use sophie_control::allocation::wrench::PerArm;
use sophie_control::pilot::bench_orders::Place;

/// Forces asked of the tendons, by what they follow from. The message's time is that of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TendonOrder {
    /// From the pressures that were converted at the message's time.
    Measured(TendonForces),
    /// From the command of the message's time alone, since no pressure is fresh: closed arms keep their force, those
    /// that are to be released lose it.
    Blind(TendonForces),
    /// From before a restart, sent once at the start: the servos stay where they are until a command comes.
    Resumed(TendonForces),
    /// On the bench: one servo at a pulse, the others by their forces, which are none.
    Placed {
        /// Of each one.
        forces: TendonForces,
        /// The one servo.
        place: Place,
    },
}

impl TendonOrder {
    /// The forces, whatever they follow from.
    pub const fn forces(&self) -> &TendonForces {
        match self {
            Self::Measured(forces)
            | Self::Blind(forces)
            | Self::Resumed(forces)
            | Self::Placed { forces, .. } => forces,
        }
    }
}

/// What is asked of the tendons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TendonForces {
    /// Of each one.
    pub arms: PerArm<TendonForce>,
    /// The tendons were found wound when the power came on: where their servos stand is to be taken from the tilt.
    pub found: bool,
}

/// What is asked of one tendon.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TendonForce {
    /// Tension, N; 0 is slack.
    pub force: f32,
    /// The servo is to stay where it is, whatever the force.
    pub stay: bool,
}
