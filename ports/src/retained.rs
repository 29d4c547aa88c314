//! Memory that outlives a reset, and what caused the reset.

/// Words of one copy of the retained state, whose layout is the tasks'.
pub const WORDS: usize = 17;
/// One copy as it lies in memory.
pub type Words = [u32; WORDS];

/// Memory that outlives a reset, though not a loss of power.
pub trait Retain {
    /// Keeps `words` as the second copy or the first. A reset in the midst of it may spoil this copy, never the other.
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
    /// Memory is noise.
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
