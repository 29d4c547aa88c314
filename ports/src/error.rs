//! Errors of the ports.

/// Why a port returned no value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortError {
    /// The part did not answer in time.
    Timeout,
    /// The part's answer fails its own check.
    Corrupt,
    /// The part is missing or was never set up.
    Absent,
    /// Another part answers.
    WrongPart,
}
