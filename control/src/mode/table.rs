//! The transition table: rows, guards and entry functions.

pub mod entries;
pub mod guards;
pub mod transitions;
