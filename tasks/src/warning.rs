//! What the pilot must know without being stopped by it.

use crate::start::StartCause;

/// A warning, shown beside the mode where no reason stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Warning {
    /// An arm's measured tilt is farther from its model than the model's correction reaches.
    ArmTilt,
    /// Why the board started, where that is not as it should be.
    Restarted(StartCause),
    /// The servo cannot give the force that the parameters allow.
    ServoWeak,
    /// The arms are softer than any that have flown.
    InfillLow,
}

impl Warning {
    /// Every warning.
    pub const ALL: [Self; 6] = [
        Self::ArmTilt,
        Self::Restarted(StartCause::BrownOut),
        Self::Restarted(StartCause::Watchdog),
        Self::Restarted(StartCause::Fault),
        Self::ServoWeak,
        Self::InfillLow,
    ];

    /// For the pilot's display; empty where there is nothing to warn of.
    pub const fn text(self) -> &'static str {
        match self {
            Self::ArmTilt => "arm tilt beyond its model",
            Self::Restarted(cause) => cause.warning(),
            Self::ServoWeak => "servo weaker than the force limit",
            Self::InfillLow => "infill below what was flown",
        }
    }
}
