//! The simulated board's chip, as its console shows it.

use sophie_ports::chip::{Chip, NotSet};
use sophie_ports::chip_check::ChipCheck;
use sophie_tasks::storage::parameters::table_id;

use super::line::Line;

/// The chip of the board on this line.
#[derive(Clone, Copy)]
pub struct ThisChip(pub &'static Line);

impl Chip for ThisChip {
    fn restart(&mut self) {
        self.0.restart();
    }

    /// The simulation has no loader; the firmware restarts at once.
    fn enter_loader(&mut self) {
        self.0.restart();
    }

    fn board(&self) -> &'static str {
        "a simulated board"
    }

    /// The simulation has no image; the parameter table stands for its identity.
    fn build(&self) -> u32 {
        sophie_image_id::of([table_id()])
    }

    fn checks(&self) -> &[ChipCheck] {
        &[]
    }

    fn brown_out_volts(&self) -> f32 {
        0.0
    }

    async fn set_brown_out(&mut self) -> Result<(), NotSet> {
        Err(NotSet)
    }
}
