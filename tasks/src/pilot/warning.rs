//! Warnings to the pilot that do not affect the modes.

use sophie_control::arming::ArmingInhibit;
use sophie_control::battery::ServoSupply;
use sophie_control::navigation::baro_height::PressureFault;
use sophie_control::navigation::external_pose::PoseFault;
use sophie_control::navigation::flow_range::{FlowRangeFault, FlowRangeLimit};
use sophie_control::navigation::position_estimator::Fault;

use sophie_ports::retained::StartCause;

/// A warning, shown beside the mode if no reason is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Warning {
    /// The accelerometer is at its full scale.
    AccelClips,
    /// The vehicle vibrates, or did when last it flew, more than a hold by flow bears.
    Vibrates,
    /// Less than a quarter of the stack is unused; an overflow stops the motors.
    Stack,
    /// An arm's tilt is beyond its model's correction.
    ArmTilt,
    /// The servo battery is low, near its end or unreadable.
    Servos(ServoSupply),
    /// Cause of an unusual start of the board.
    Restarted(StartCause),
    /// Pose, flow, range or air pressure is rejected as faulty.
    Position(Fault),
    /// Optical flow is unusable at the present height, range or light.
    Limit(FlowRangeLimit),
    /// The servo cannot reach the force limit of the parameters.
    ServoWeak,
    /// The infill is below the lowest one flown: softer arms.
    InfillLow,
}

impl Warning {
    /// Every warning.
    pub const ALL: [Self; 28] = [
        Self::AccelClips,
        Self::Vibrates,
        Self::Stack,
        Self::ArmTilt,
        Self::Servos(ServoSupply::NearEnd),
        Self::Servos(ServoSupply::Low),
        Self::Servos(ServoSupply::Silent),
        Self::Restarted(StartCause::BrownOut),
        Self::Restarted(StartCause::Watchdog),
        Self::Restarted(StartCause::Fault),
        Self::Position(Fault::Pose(PoseFault::Frozen)),
        Self::Position(Fault::Pose(PoseFault::Jumps)),
        Self::Position(Fault::Pose(PoseFault::Disagrees)),
        Self::Position(Fault::FlowRange(FlowRangeFault::FlowFrozen)),
        Self::Position(Fault::FlowRange(FlowRangeFault::FlowDisagrees)),
        Self::Position(Fault::FlowRange(FlowRangeFault::RangeFrozen)),
        Self::Position(Fault::FlowRange(FlowRangeFault::RangeJumps)),
        Self::Position(Fault::FlowRange(FlowRangeFault::RangeScaled)),
        Self::Position(Fault::FlowRange(FlowRangeFault::RangeInconsistent)),
        Self::Position(Fault::Pressure(PressureFault::Frozen)),
        Self::Position(Fault::Pressure(PressureFault::Jumps)),
        Self::Position(Fault::Pressure(PressureFault::Disagrees)),
        Self::Limit(FlowRangeLimit::TooLow),
        Self::Limit(FlowRangeLimit::TooHigh),
        Self::Limit(FlowRangeLimit::NoRange),
        Self::Limit(FlowRangeLimit::TooDark),
        Self::ServoWeak,
        Self::InfillLow,
    ];

    /// Text on the pilot's display; empty without cause.
    pub const fn text(self) -> &'static str {
        match self {
            Self::AccelClips => "vibration: accelerometer clips",
            Self::Vibrates => "vibration: balance the propellers",
            Self::Stack => "stack nearly full",
            Self::ArmTilt => "arm tilt beyond its model",
            Self::Servos(ServoSupply::NearEnd) => "servo battery near its end",
            Self::Servos(ServoSupply::Low) => ArmingInhibit::ServoBatteryLow.text(),
            Self::Servos(ServoSupply::Silent) => ArmingInhibit::ServoBatterySilent.text(),
            Self::Servos(ServoSupply::NotFitted | ServoSupply::Good) => "",
            Self::Restarted(cause) => cause.warning(),
            Self::Position(fault) => fault.text(),
            Self::Limit(limit) => limit.text(),
            Self::ServoWeak => "servo weaker than the force limit",
            Self::InfillLow => "infill below what was flown",
        }
    }
}
