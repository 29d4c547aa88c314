//! Orders that a ground station or a companion computer may give beside the pilot's radio, and the replies of the mode
//! logic.
//!
//! The pilot's link stays in command: an order stands for a gesture or a switch position of the pilot, meets the same
//! conditions, and never overrides a prohibition by his own switches ([`crate::mode::ModeLogic`]).

/// An order of a remote link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemoteOrder {
    /// The arming gesture.
    Arm,
    /// The disarming gesture.
    Disarm,
    /// The arm switch turned off, in any mode.
    Kill,
    /// The perch switch turned on.
    Grab,
    /// The perch switch turned off.
    Release,
}

/// An order under its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RemoteRequest {
    /// Counts from 1, over all senders: a number that is not above the last is ignored.
    pub number: u32,
    /// The order.
    pub order: RemoteOrder,
}

/// Declares why an order is refused: name and text.
macro_rules! remote_refusals {
    ($($(#[$doc:meta])+ $name:ident = $text:literal;)+) => {
        /// Why an order is refused.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum RemoteRefusal { $($(#[$doc])+ $name,)+ }

        impl RemoteRefusal {
            /// Every refusal.
            pub const ALL: [Self; [$($text),+].len()] = [$(Self::$name),+];

            /// Text for the sender, at most 40 ASCII characters.
            pub const fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }
        }
    };
}

remote_refusals! {
    /// An arming check fails; the commander's view lists the failed checks.
    Checks = "arming checks fail";
    /// The pilot's radio is received and its arm switch forbids running motors, or a release.
    ArmSwitchOff = "arm switch off";
    /// Off the pipe, or on it without a grip, the arm switch comes first.
    ArmSwitchOn = "arm switch on: turn it off first";
    /// The rotors carry the vehicle.
    Flying = "flying: land first";
    /// Without radio the pilot could not take over.
    RadioLost = "radio lost";
    /// The perch switch has no effect in this mode.
    NotHere = "only in flight or on the pipe";
    /// The pilot's switch has been on since the last try.
    SwitchNotOff = "turn perch switch off first";
    /// A release requires that the switch was on or a grab was obeyed.
    SwitchNotOn = "turn perch switch on or grab first";
    /// A danger forbids leaving the pipe: battery or data-ready line.
    MustStay = "must stay: battery or inertial sensor";
    /// The belly would slide before the rotors carry the weight.
    LeansTooFar = "leaning too far to let go";
    /// The throttle is too low to carry the vehicle, or so high that the rotors would tear at the arms.
    Throttle = "throttle not set for a release";
    /// Autonomous perching requires centred sticks.
    SticksNotCentred = "centre the sticks first";
    /// Autonomous perching requires a thrust learnt in free flight.
    ThrustUnknown = "thrust not learnt yet: fly on";
    /// Autonomous perching requires a position and a range.
    NoWay = "no position or no range to perch by";
}

/// The reply to the order with this number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RemoteAnswer {
    /// Number of the order; 0 before the first.
    pub number: u32,
    /// Reason of the refusal; `None`: obeyed.
    pub refusal: Option<RemoteRefusal>,
}
