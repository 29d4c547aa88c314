//! Recordings of sensors and of bytes, run through this stack's own filter, estimators and decoders.
//!
//! Open loop: the recording is the input, the stack's estimates are the output. docs/recording.md has the formats.

pub mod bytes;
mod event;
mod lines;
pub mod replay;
pub mod report;
mod sensors;
mod table;
pub mod truth;

#[cfg(test)]
use sophie_clock as _;
