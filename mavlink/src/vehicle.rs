//! What the server says of the vehicle: one picture of it, in the units of the flight stack.

use sophie_control::mode::Mode;

/// The vehicle at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vehicle {
    /// What it is doing; `None` while the commander is silent.
    pub mode: Option<Mode>,
}
