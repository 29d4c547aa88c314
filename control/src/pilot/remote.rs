//! What a ground station or a companion computer may order beside the pilot's radio, and what the mode logic answers.
//!
//! The pilot's link stays the one that flies: an order stands for a gesture or a turn of a switch that he could make, is
//! held to the same conditions, and never lifts what his own switches forbid ([`crate::mode::ModeLogic`]).

/// What is ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RemoteOrder {
    /// The arming gesture.
    Arm,
    /// The disarming gesture.
    Disarm,
    /// The arm switch turned off, wherever the vehicle is.
    Kill,
    /// The perch switch turned on.
    Grab,
    /// The perch switch turned off.
    Release,
}

/// An order under its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RemoteRequest {
    /// Counts from 1, over all who give orders: one that is not above the last is not obeyed again.
    pub number: u32,
    /// What is ordered.
    pub order: RemoteOrder,
}

/// Declares why an order is refused: name and text.
macro_rules! remote_refusals {
    ($($(#[$doc:meta])+ $name:ident = $text:literal;)+) => {
        /// Why an order is refused.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum RemoteRefusal { $($(#[$doc])+ $name,)+ }

        impl RemoteRefusal {
            /// Every one.
            pub const ALL: [Self; [$($text),+].len()] = [$(Self::$name),+];

            /// For who gave the order, at most 40 ASCII characters.
            pub const fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }
        }
    };
}

remote_refusals! {
    /// An arming check fails: which ones is in the commander's view.
    Checks = "arming checks fail";
    /// A radio is there and forbids running motors, or a release.
    ArmSwitchOff = "arm switch off";
    /// Off the pipe or out of its grip the arm switch comes first.
    ArmSwitchOn = "arm switch on: turn it off first";
    /// Rotors carry the vehicle.
    Flying = "flying: land first";
    /// No pilot who could take over.
    RadioLost = "radio lost";
    /// The perch switch would do nothing here.
    NotHere = "only in flight or on the pipe";
    /// The pilot's switch has been on since the last try.
    SwitchNotOff = "turn perch switch off first";
    /// The switch, or a grab, comes before a release.
    SwitchNotOn = "turn perch switch on or grab first";
    /// What forbids to leave the pipe: battery or data-ready line.
    MustStay = "must stay: battery or inertial sensor";
    /// The belly would slide before the rotors carry.
    LeansTooFar = "leaning too far to let go";
    /// The rotors could not carry, or would tear at the arms.
    Throttle = "throttle not set for a release";
    /// Perching by itself waits for hands off the sticks.
    SticksNotCentred = "centre the sticks first";
    /// It cannot be done by itself without both.
    NoWay = "no position or no range to perch by";
}

/// The answer to the order with this number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RemoteAnswer {
    /// The order's; 0 before the first.
    pub number: u32,
    /// Why it was refused; `None`: obeyed.
    pub refusal: Option<RemoteRefusal>,
}
