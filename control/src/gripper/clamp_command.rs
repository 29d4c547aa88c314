//! Wanted action of the tendons, from the mode logic.

use crate::pilot::actuator_test::Place;
use crate::pilot::rc::ArmChoice;

/// Wanted action of the tendons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ClampCommand {
    /// Slack, servos at their release position.
    #[default]
    Release,
    /// Close these arms to the grip pressure.
    Close {
        /// Which arms.
        arms: ArmChoice,
    },
    /// The same, beyond the grip pressure.
    Tighten {
        /// Which arms.
        arms: ArmChoice,
        /// How often they were tightened, 1 to [`TIGHTENINGS`](crate::gripper::TIGHTENINGS).
        times: u8,
    },
    /// No pulses: the gears keep hold as at power-up.
    Keep,
    /// One servo at a test pulse, the others as with [`Self::Release`].
    Place(Place),
}
