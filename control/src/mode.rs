//! The vehicle's modes, and the mode logic, stepped at 100 Hz.
//!
//! `modes` lists the modes; each has a file in `states` with its fields (`behaviour::Behaviour`); `context` holds the
//! data that outlive a mode. `table::transitions` lists the transitions by priority, as printed in `docs/modes.md`;
//! `table::guards` has their conditions and `table::entries` their entry functions.

mod behaviour;
mod context;
mod inputs;
mod logic;
mod modes;
mod outputs;
mod reason;
mod remote_refusal;
mod shared;
mod state;
mod states;
mod table;
#[cfg(test)]
mod tests;

pub use self::inputs::Inputs;
pub use self::logic::ModeLogic;
pub use self::modes::Mode;
pub use self::outputs::Outputs;
pub use self::reason::Reason;
pub use self::states::escaping::{AWAY_LEAN as ESCAPE_LEAN, LIFT_SHARE as ESCAPE_LIFT};
