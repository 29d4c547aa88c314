//! A fake chip for the console's commands.

use std::cell::Cell;
use std::rc::Rc;

use sophie_ports::chip::{Chip, NotSet};
use sophie_ports::chip_check::ChipCheck;
use sophie_ports::stack_use::StackUse;

/// A chip that counts its restarts and may refuse its brown-out level.
#[derive(Clone, Default)]
pub struct FakeChip {
    /// Restarts so far.
    pub restarts: Rc<Cell<u32>>,
    /// Brown-out level, 0 to 3.
    pub level: Rc<Cell<u8>>,
    /// The level cannot be set.
    pub refuses: bool,
    /// Results of the start-up checks.
    pub checks: Vec<ChipCheck>,
    /// Greatest depth of its stack.
    pub stack: Option<StackUse>,
}

impl Chip for FakeChip {
    fn restart(&mut self) {
        self.restarts.set(self.restarts.get() + 1);
    }

    fn enter_loader(&mut self) {}

    fn board(&self) -> &'static str {
        "table"
    }

    fn build(&self) -> u32 {
        0x1234_ABCD
    }

    fn checks(&self) -> &[ChipCheck] {
        &self.checks
    }

    fn stack(&self) -> Option<StackUse> {
        self.stack
    }

    fn brown_out_volts(&self) -> f32 {
        2.7
    }

    async fn set_brown_out(&mut self) -> Result<(), NotSet> {
        if self.refuses {
            return Err(NotSet);
        }
        self.level.set(3);
        Ok(())
    }
}
