//! Start-up checks of the chip: each compares a setting's reading with the value for which the firmware is built.

use heapless::{String, Vec};
use sophie_control::arming::ArmingInhibit;

/// Longest text of a reading, bytes.
pub const READ: usize = 28;

/// Name of the check that reads the chip's revision.
pub const REVISION: &str = "revision";

/// One check of the chip by the start-up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChipCheck {
    /// Name of the setting.
    pub name: &'static str,
    /// The reading.
    pub read: String<READ>,
    /// The value for which the firmware is built.
    pub expected: &'static str,
    /// The reading is as expected.
    pub ok: bool,
    /// The arming check that a failure trips; `None` if the vehicle can fly with it.
    pub inhibits: Option<ArmingInhibit>,
}

/// Most checks of a start-up.
pub const CHECKS: usize = 12;

/// All checks of a start-up.
pub type ChipChecks = Vec<ChipCheck, CHECKS>;
