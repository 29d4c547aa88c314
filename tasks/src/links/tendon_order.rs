//! Tendon forces demanded by the clamp, and the input that they are based on.

use sophie_control::allocation::wrench::PerArm;
use sophie_control::pilot::actuator_test::Place;

/// Demanded tendon forces, by the input that they are based on; the message is stamped with that input's time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TendonOrder {
    /// Based on pressures converted at the message's time.
    Measured(TendonForces),
    /// Based on the command alone, since no pressure is fresh: closed arms keep their force, released arms lose it.
    Blind(TendonForces),
    /// Retained from before a restart, sent once at the start: the servos hold their position until a command arrives.
    Resumed(TendonForces),
    /// Actuator test: one servo at a given pulse; the forces of the others are zero.
    Placed {
        /// Per arm.
        forces: TendonForces,
        /// The servo under test and its pulse.
        place: Place,
    },
}

impl TendonOrder {
    /// The forces, whatever their input.
    pub const fn forces(&self) -> &TendonForces {
        match self {
            Self::Measured(forces)
            | Self::Blind(forces)
            | Self::Resumed(forces)
            | Self::Placed { forces, .. } => forces,
        }
    }
}

/// Demand on all tendons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonForces {
    /// Per arm.
    pub arms: PerArm<TendonForce>,
    /// The tendons were wound at power-on: the servo angles must be derived from the tilt.
    pub wound_at_power_on: bool,
}

/// Demand on one tendon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TendonForce {
    /// Tension, N; 0 is slack.
    pub force: f32,
    /// Stiffness over that of the parameters, 0..1.
    pub stiffness: f32,
    /// Hold the servo's position and ignore the force.
    pub hold_position: bool,
}
