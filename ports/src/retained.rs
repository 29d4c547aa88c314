//! Memory that survives a reset, and the cause of the reset.

/// Words of one copy of the retained state, whose layout is the tasks'.
pub const WORDS: usize = 17;
/// One copy as it lies in memory.
pub type Words = [u32; WORDS];

/// Memory that survives a reset, but not a loss of power.
pub trait Retain {
    /// Stores `words` as the second copy or the first. A reset during the call may spoil this copy, never the other.
    fn keep(&mut self, second: bool, words: &Words);
}

/// Cause of a start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartCause {
    /// Power was switched on.
    #[default]
    PowerOn,
    /// The supply dipped: memory is lost.
    BrownOut,
    /// The watchdog was not fed.
    Watchdog,
    /// Panic or processor fault.
    Fault,
    /// Command, reset button or debug probe.
    Software,
}

impl StartCause {
    /// The retained memory is noise after this start.
    pub const fn loses_memory(self) -> bool {
        matches!(self, Self::PowerOn | Self::BrownOut)
    }

    /// Warning for the pilot; empty if none.
    pub const fn warning(self) -> &'static str {
        match self {
            Self::PowerOn | Self::Software => "",
            Self::BrownOut => "restarted by a brown-out",
            Self::Watchdog => "restarted by the watchdog",
            Self::Fault => "restarted after a fault",
        }
    }
}
