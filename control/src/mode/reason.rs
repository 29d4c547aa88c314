//! Reasons for being in a mode, staying in it or having left the last one, each with its text.

use crate::arming::ArmingInhibit;
use crate::gripper::grip_fault::GripFault;

/// Declares the reasons that carry nothing, with the text of each.
macro_rules! reasons {
    ($($(#[$doc:meta])+ $name:ident = $text:literal,)+) => {
        /// Why the vehicle is in its mode, stays in it, or has left the one before.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Reason {
            /// What also forbids arming.
            Check(ArmingInhibit),
            /// A chosen arm is faulty.
            ArmFault(Option<GripFault>),
            $($(#[$doc])+ $name,)+
        }

        impl Reason {
            /// Every reason beside those of the arming checks and of the arms' faults.
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
    OnBench = "bench command running",
    /// The rotors have idled for too long.
    IdleTooLong = "idle for too long",
    /// The battery is at its end.
    BatteryCritical = "battery critical",
    /// The vehicle lies on its side or its back.
    TippedOver = "tipped over",
    /// A landing on the pipe takes a new turn of the perch switch.
    PerchSwitchNotOff = "turn perch switch off first",
    /// It feels the pipe and leans too much to close the arms.
    NotOnCrown = "leaning, not on the crown",
    /// A hold takes a new turn of its switch.
    HoldSwitchNotOff = "turn hold switch off first",
    /// Nobody has said in time where the vehicle is.
    NoPosition = "no position to hold",
    /// Holding: height and learnt wind alone, until a position comes or the hold ends.
    PositionStale = "position stale: steer it",
    /// The hold has ended.
    PositionLost = "position lost: throttle to hover",
    /// Perching by itself takes centred sticks, so that their motion can end it.
    SticksNotCentred = "centre the sticks to perch",
    /// Perching by itself takes a fresh range, or a place of the pipe.
    NoRange = "no range to perch by",
    /// The pilot has ended the perching by itself.
    TakenOver = "perching ended by the pilot",
    /// Perching by itself: no pipe across the whole search.
    NoPipe = "no pipe found",
    /// Perching by itself: no room between the pipe's ends.
    PipeTooShort = "pipe too short to perch",
    /// Perching by itself: the range no longer sees the pipe.
    PipeLost = "pipe lost from below",
    /// Perching by itself: not at rest over the crown in time.
    NotCentred = "not settled over the crown",
    /// Perching by itself: nothing was touched.
    NotTouched = "nothing touched at the crown",
    /// Perching by itself: something carries it where nothing was seen so near.
    TouchedEarly = "touched before the crown: climbing",
    /// Perching by itself: the range is missing.
    RangeStale = "range stale",
    /// Perching by itself: the height by the range goes another way than the vehicle.
    RangeMisfit = "range does not fit the motion",
    /// Perching by itself: another computer no longer says where the pipe is.
    TargetStale = "pipe target stale",
    /// Perching by itself: where the pipe is said to be it cannot be.
    TargetFar = "pipe target not near and below",
    /// Perching by itself: the pipe is said to be elsewhere.
    TargetJumps = "pipe target jumps",
    /// The vehicle leaves the pipe by itself.
    SlidesOff = "sliding off the pipe",
    /// After an escape the throttle has not been moved.
    NotTakenOver = "throttle not taken over",
    /// The perch switch was turned off while the arms closed.
    ClosingCancelled = "closing cancelled",
    /// A chosen arm pulls as hard as it may and does not hold.
    ForceLimit = "force limit reached without grip",
    /// The arms press as round another pipe than the parameters', or round none.
    PipeMisfit = "arms do not fit the pipe",
    /// The arms press round a pipe that does not run lengthwise.
    PipeOblique = "pipe is oblique: line up with it",
    /// The arms press round a pipe to one side, or one of them presses on something else.
    ArmsUneven = "arms lie unevenly",
    /// A tendon hardly pulls: the other arms press this one.
    ArmsOpposed = "arms pull against each other",
    /// The arms press, but friction would not hold this lean once the rotors stand.
    LeansToStay = "leaning too far to stay",
    /// The arms have closed for as long as they may.
    GripNotProven = "grip not proven in time",
    /// The rotors come back because the arms do not hold any more.
    GripLostSpooling = "grip lost while spooling down",
    /// Resting on the pipe: the crown is to the left.
    CrownLeft = "on the pipe: crown to the left",
    /// Resting on the pipe: the crown is to the right.
    CrownRight = "on the pipe: crown to the right",
    /// Perched: the body turns about the pipe, and the arms tighten for the first time.
    TightensOnce = "slips: arms tighten, 1 of 2",
    /// The same for the last time.
    TightensLast = "slips: arms tighten, 2 of 2",
    /// Perched: the body goes on turning about the pipe, and the arms do not tighten any more.
    Slips = "slipping round the pipe",
    /// Perched: nothing is known of the grip.
    ClampSilent = "clamp loop silent",
    /// Perched: an arm does not hold any more.
    GripLost = "grip lost",
    /// A release takes a new turn of the perch switch.
    PerchSwitchNotOn = "turn perch switch on first",
    /// A release takes the arm switch.
    ArmSwitchOff = "arm switch off",
    /// The arms are not opened: the belly would slide before the rotors carry.
    LeansTooFar = "leaning too far to let go",
    /// The arms open while the rotors lift it off: the belly would slide.
    LiftsOff = "leaning: lifting off",
    /// A release takes less throttle.
    ThrottleTooHigh = "throttle too high to release",
    /// The arms are open, and their sensors still press.
    ArmsStuck = "arms do not come free",
}

impl Reason {
    /// No frame from the receiver.
    pub const RADIO_LOST: Self = Self::Check(ArmingInhibit::RcLost);
    /// No fresh attitude.
    pub const IMU_SILENT: Self = Self::Check(ArmingInhibit::ImuStale);
    /// No fresh voltage of the flight battery.
    pub const BATTERY_SILENT: Self = Self::Check(ArmingInhibit::BatterySilent);
    /// The inertial sensor is read by the clock, its data-ready line being silent.
    pub const LINE_SILENT: Self = Self::Check(ArmingInhibit::ImuLineSilent);
}
