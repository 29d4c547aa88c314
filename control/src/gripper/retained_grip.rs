//! Grip state, retained across motor stop and reset.
//!
//! The mode logic decides it at 100 Hz; the supervisor copies it into memory that a reset keeps.

use crate::gripper::clamp_command::ClampCommand;
use crate::pilot::rc::ArmChoice;

/// Action of the tendons on the pipe, retained.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GripMemory {
    /// Not checked since power-up: the arms may be closed.
    #[default]
    Unknown,
    /// Open, or opening on the pilot's command.
    Open,
    /// Closed, closing, or not proven free: the clamp loops hold these arms.
    Controlled(ArmChoice),
    /// Found pressed at power-up, servo angles unknown: the gears hold these arms.
    HeldByGears(ArmChoice),
}

impl GripMemory {
    /// Tendon command that keeps this grip.
    pub const fn tendons(self) -> ClampCommand {
        match self {
            Self::Open => ClampCommand::Release,
            Self::Controlled(arms) => ClampCommand::Close { arms },
            Self::HeldByGears(_) | Self::Unknown => ClampCommand::Keep,
        }
    }

    /// Arms that hold something.
    pub const fn arms(self) -> Option<ArmChoice> {
        match self {
            Self::Controlled(arms) | Self::HeldByGears(arms) => Some(arms),
            Self::Open | Self::Unknown => None,
        }
    }
}
