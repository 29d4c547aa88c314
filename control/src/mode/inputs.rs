//! What asks for a mode: autonomous perching, ground station, bench, dangers.

pub mod auto_perch;
pub mod bench;
pub mod dangers;
pub mod remote;
