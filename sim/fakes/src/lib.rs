//! Test doubles for hardware: scripted ports, and a flash with power cuts.

mod flash;
mod ports;

pub use flash::{Cells, Flash, FlashError};
pub use ports::*;
