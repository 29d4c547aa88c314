//! Test doubles for hardware: scripted ports, and a flash with power cuts.

mod chip;
mod flash;
mod ports;

pub use chip::FakeChip;
pub use flash::{Cells, Flash, FlashError};
pub use ports::*;
