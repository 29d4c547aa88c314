//! The vehicle's modes, and the mode logic, stepped at 100 Hz.
//!
//! `modes` names them; each has a file in `states` with its fields (`behaviour::Behaviour`); `context` holds what outlives
//! it. `table::transitions` lists the transitions by priority, shown in `docs/modes.md`, with conditions in `table::guards`
//! and entry functions in `table::entries`.

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
