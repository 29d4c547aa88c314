//! State of the MAVLink line: signing and inputs.

use sophie_mavlink::inputs::Counts;
use sophie_mavlink::wire::signing::{Refused, Signing};
use sophie_ports::signing::Stored;

/// Whether frames of MAVLink are signed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SigningState {
    /// No key is stored.
    #[default]
    Off,
    /// A key is in force.
    On,
    /// The storage cannot be read: all commands are refused.
    Unknown,
    /// The storage could not be read and was erased: all commands are refused until a key is set or removed.
    Lost,
}

/// State of the MAVLink lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LineState {
    /// Whether frames are signed.
    pub signing: SigningState,
    /// Frames that were refused for their signature since the start.
    pub refused: Refused,
    /// Inputs from outside since the start.
    pub inputs: Counts,
}

impl LineState {
    /// State of `signing` and of the external inputs.
    pub const fn of(signing: &Signing, inputs: Counts) -> Self {
        Self {
            signing: match signing.stored() {
                Stored::None => SigningState::Off,
                Stored::Key(_) => SigningState::On,
                Stored::Unreadable => SigningState::Unknown,
                Stored::Lost => SigningState::Lost,
            },
            refused: signing.refused(),
            inputs,
        }
    }
}
