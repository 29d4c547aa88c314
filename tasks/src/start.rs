//! Cause of a start, and the state retained from the last run.

pub mod retained_state;

use crate::start::retained_state::RetainedState;
use sophie_ports::retained::{StartCause, Words};

/// A start of the board.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Its cause.
    pub cause: StartCause,
    /// Valid retained state of the last run.
    pub retained: Option<RetainedState>,
    /// Sequence number of the last copy.
    pub sequence: u32,
}

impl Start {
    /// Power-on, nothing retained.
    pub const COLD: Self = Self {
        cause: StartCause::PowerOn,
        retained: None,
        sequence: 0,
    };

    /// A start with these copies in retained memory.
    pub fn new(cause: StartCause, copies: &[Words; 2]) -> Self {
        let kept = if cause.loses_memory() {
            None
        } else {
            RetainedState::newest(copies)
        };
        Self {
            cause,
            retained: kept.map(|(retained, _)| retained),
            sequence: kept.map_or(0, |(_, sequence)| sequence),
        }
    }
}

#[cfg(test)]
mod tests {
    use sophie_control::gripper::retained_grip::GripMemory;
    use sophie_control::pilot::rc::ArmChoice;

    use super::*;
    use sophie_ports::retained::WORDS;

    #[test]
    fn memory_is_trusted_only_where_power_never_went() {
        let retained = RetainedState {
            grip_memory: GripMemory::Controlled(ArmChoice::All),
            force: [50.0; 4],
            ..RetainedState::default()
        };
        let copy = retained.to_words(8).unwrap_or_default();
        for (cause, trusted) in [
            (StartCause::PowerOn, false),
            (StartCause::BrownOut, false),
            (StartCause::Watchdog, true),
            (StartCause::Fault, true),
            (StartCause::Software, true),
        ] {
            let start = Start::new(cause, &[copy, [0; WORDS]]);
            assert_eq!(start.retained, trusted.then_some(retained), "{cause:?}");
            assert_eq!(start.sequence, if trusted { 8 } else { 0 });
            assert!(Start::new(cause, &[[7; WORDS]; 2]).retained.is_none());
            assert!(cause.warning().len() <= 40);
        }
    }
}
