//! The grip as it must be remembered: over stopped rotors, and over a reset.
//!
//! The mode logic decides it at 100 Hz, and the supervisor copies it into memory that a reset leaves alone.

use crate::rc::ArmChoice;
use crate::setpoint::ClampCommand;

/// What the tendons do to the pipe, as far as it must outlive the rotors and a reset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GripMemory {
    /// Not looked at yet since the power came on: the arms may be closed.
    #[default]
    Unknown,
    /// Open, or opening because a person wanted it.
    Open,
    /// These arms are closed, closing, or not proven free yet: the clamp loops hold them.
    Controlled(ArmChoice),
    /// These arms were found pressed when the power came on; where their servos stand is not known. The gears hold.
    HeldByGears(ArmChoice),
}

impl GripMemory {
    /// What the tendons do that keeps it.
    pub const fn tendons(self) -> ClampCommand {
        match self {
            Self::Open => ClampCommand::Release,
            Self::Controlled(arms) => ClampCommand::Close { arms },
            Self::HeldByGears(_) | Self::Unknown => ClampCommand::Keep,
        }
    }

    /// The arms that hold something.
    pub const fn arms(self) -> Option<ArmChoice> {
        match self {
            Self::Controlled(arms) | Self::HeldByGears(arms) => Some(arms),
            Self::Open | Self::Unknown => None,
        }
    }
}
