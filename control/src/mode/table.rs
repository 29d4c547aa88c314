//! The transition table: rows, guards and what happens on entry.

pub mod entries;
pub mod guards;
pub mod transitions;
