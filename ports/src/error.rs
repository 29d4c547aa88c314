//! Why a port gave nothing.

/// Why a port gave nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PortError {
    /// The part did not answer in time.
    Timeout,
    /// The part answered with something that fails its own check.
    Corrupt,
    /// The part is not there or was never set up.
    Absent,
    /// Another part answers.
    WrongPart,
}
