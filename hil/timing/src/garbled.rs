//! The error of a line.

/// A line that is not whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Garbled;
