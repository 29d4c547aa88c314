//! Test doubles for hardware: scripted ports, and a flash whose power fails.

mod flash;
mod ports;

pub use flash::{Cells, Flash, FlashError};
pub use ports::*;
