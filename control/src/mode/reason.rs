//! Reasons for being in a mode, staying in it or having left the last one, each with its text.

use crate::arming::ArmingInhibit;
use crate::gripper::grip_fault::GripFault;

/// Declares the reasons without a field, with the text of each.
macro_rules! reasons {
    ($($(#[$doc:meta])+ $name:ident = $text:literal,)+) => {
        /// Why the vehicle entered its mode, stays in it, or left the previous one.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Reason {
            /// A failed arming check.
            Check(ArmingInhibit),
            /// A chosen arm is faulty.
            ArmFault(Option<GripFault>),
            $($(#[$doc])+ $name,)+
        }

        impl Reason {
            /// Every reason except the arming checks and the arms' faults.
            pub const PLAIN: &'static [Self] = &[$(Self::$name),+];

            /// For the pilot's display: at most 40 ASCII characters.
            pub const fn text(self) -> &'static str {
                match self {
                    Self::Check(check) => check.text(),
                    Self::ArmFault(Some(fault)) => fault.text(),
                    Self::ArmFault(None) => "arm fault",
                    $(Self::$name => $text,)+
                }
            }
        }
    };
}

reasons! {
    /// Calibrating: the vehicle must not be moved.
    KeepStill = "keep still",
    /// Disarmed: a builder tries a motor or a servo.
    ActuatorTest = "actuator test running",
    /// The rotors have idled for too long.
    IdleTooLong = "idle for too long",
    /// The battery is at its end.
    BatteryCritical = "battery critical",
    /// The vehicle lies on its side or its back.
    TippedOver = "tipped over",
    /// A landing on the pipe takes a new turn of the perch switch.
    PerchSwitchNotOff = "turn perch switch off first",
    /// It touches the pipe and leans too much to close the arms.
    NotOnCrown = "leaning, not on the crown",
    /// A hold takes a new turn of its switch.
    HoldSwitchNotOff = "turn hold switch off first",
    /// The position estimate is missing or too old to begin a hold.
    NoPosition = "no position to hold",
    /// The motors lag more than any that a hold was flown with.
    MotorsTooSlow = "motors too slow to hold",
    /// Hold by dead reckoning: height and estimated wind only, until a position returns or the hold ends.
    PositionStale = "dead reckoning: steer it",
    /// The hold has ended.
    PositionLost = "position lost: throttle to hover",
    /// The vehicle swings in the hold: motors slower than the parameter, softer arms, or gains too high.
    Swings = "swings: check motor_tau and gains",
    /// Autonomous perching requires centred sticks, so that the pilot ends it by moving one.
    SticksNotCentred = "centre the sticks to perch",
    /// Autonomous perching requires a thrust learnt in free flight: contact shows by the force that is no thrust.
    ThrustUnknown = "thrust not learnt yet: fly on",
    /// Autonomous perching requires a fresh range, or a known position of the pipe.
    NoRange = "no range to perch by",
    /// The pilot has ended autonomous perching.
    TakenOver = "perching ended by the pilot",
    /// Autonomous perching: the whole search found no pipe.
    NoPipe = "no pipe found",
    /// Autonomous perching: too little room between the pipe's ends.
    PipeTooShort = "pipe too short to perch",
    /// Autonomous perching: the range has lost the pipe.
    PipeLost = "pipe lost from below",
    /// Autonomous perching: the vehicle did not settle over the crown in time.
    NotCentred = "not settled over the crown",
    /// Autonomous perching: no contact at touchdown.
    NotTouched = "no contact at touchdown",
    /// Autonomous perching: contact earlier than the range predicts.
    TouchedEarly = "early contact: climbing",
    /// Autonomous perching: the range is missing.
    RangeStale = "range stale",
    /// Autonomous perching: height by the range is inconsistent with the vehicle's motion.
    RangeMisfit = "range inconsistent",
    /// Autonomous perching: the companion computer has stopped sending the pipe's position.
    TargetStale = "pipe target stale",
    /// Autonomous perching: the reported position of the pipe is implausible.
    TargetFar = "pipe target not near and below",
    /// Autonomous perching: the reported position of the pipe has jumped.
    TargetJumps = "pipe target jumps",
    /// The vehicle leaves the pipe autonomously.
    SlidesOff = "sliding off the pipe",
    /// The throttle has not been moved after an escape.
    NotTakenOver = "throttle not taken over",
    /// The perch switch was turned off while the arms closed.
    ClosingCancelled = "closing cancelled",
    /// A chosen arm pulls at its force limit and does not hold.
    ForceLimit = "force limit reached without grip",
    /// The arms are bent as round a pipe of another diameter, or round none.
    PipeMisfit = "arms do not fit the pipe",
    /// The arms press round a pipe that does not run lengthwise.
    PipeOblique = "pipe is oblique: line up with it",
    /// The arms press round a pipe to one side, or one of them presses on something else.
    ArmsUneven = "arms lie unevenly",
    /// A tendon hardly pulls: the other arms press this one.
    ArmsOpposed = "arms pull against each other",
    /// The arms press, but friction would not hold this lean once the rotors stand.
    LeansToStay = "leaning too far to stay",
    /// The closing has taken its longest time.
    GripNotProven = "grip not proven in time",
    /// The rotors spool up again because the arms have lost their hold.
    GripLostSpooling = "grip lost while spooling down",
    /// Resting on the pipe: the crown is to the left.
    CrownLeft = "on the pipe: crown to the left",
    /// Resting on the pipe: the crown is to the right.
    CrownRight = "on the pipe: crown to the right",
    /// Perched: the body turns about the pipe; first tightening of the arms.
    TightensOnce = "slips: arms tighten, 1 of 2",
    /// Second and last tightening.
    TightensLast = "slips: arms tighten, 2 of 2",
    /// Perched: the body keeps turning about the pipe after the last tightening.
    Slips = "slipping round the pipe",
    /// Perched: the state of the grip is unknown.
    ClampSilent = "clamp loop silent",
    /// Perched: an arm has lost its hold.
    GripLost = "grip lost",
    /// A release takes a new turn of the perch switch.
    PerchSwitchNotOn = "turn perch switch on first",
    /// A release takes the arm switch.
    ArmSwitchOff = "arm switch off",
    /// The arms stay closed: the belly would slide before the rotors carry the weight.
    LeansTooFar = "leaning too far to let go",
    /// The rotors lift the vehicle off while the arms open, since the belly would slide.
    LiftsOff = "tilt limit: lift-off",
    /// A release takes less throttle.
    ThrottleTooHigh = "throttle too high to release",
    /// The tendons are slack, and the arms' pressure sensors still read contact.
    ArmsStuck = "arms do not come free",
}

impl Reason {
    /// No frame from the receiver.
    pub const RADIO_LOST: Self = Self::Check(ArmingInhibit::RcLost);
    /// No fresh attitude.
    pub const IMU_SILENT: Self = Self::Check(ArmingInhibit::ImuStale);
    /// No fresh voltage of the flight battery.
    pub const BATTERY_SILENT: Self = Self::Check(ArmingInhibit::BatterySilent);
    /// The data-ready line of the inertial sensor is silent; the sensor is polled by the clock.
    pub const LINE_SILENT: Self = Self::Check(ArmingInhibit::ImuLineSilent);
}
