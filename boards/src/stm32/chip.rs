//! The chip: restart, option bytes, results of start-up checks.

use sophie_ports::chip::{Chip, NotSet};
use sophie_ports::chip_check::{ChipCheck, ChipChecks};
use sophie_ports::stack_use::StackUse;
use static_cell::StaticCell;

use super::loader::leave_for_loader;
use super::{options, watchdog};
use crate::cortex_m::restart::reset;
use crate::cortex_m::{image, stack};
use crate::{NAME, stop_motors};

static CHECKS: StaticCell<ChipChecks> = StaticCell::new();

/// The chip.
#[derive(Clone, Copy)]
pub struct ThisChip {
    /// Results of the start-up checks.
    pub checks: &'static [ChipCheck],
}

impl ThisChip {
    /// The chip with the check results `looks`. Called once.
    pub fn new(checks: ChipChecks) -> Self {
        Self {
            checks: CHECKS.init(checks),
        }
    }
}

/// Restarts the chip, motors stopped first.
pub fn restart() -> ! {
    stop_motors();
    reset()
}

impl Chip for ThisChip {
    fn restart(&mut self) {
        restart()
    }

    fn enter_loader(&mut self) {
        leave_for_loader()
    }

    fn board(&self) -> &'static str {
        NAME
    }

    fn build(&self) -> u32 {
        image::id()
    }

    fn checks(&self) -> &[ChipCheck] {
        self.checks
    }

    fn stack(&self) -> Option<StackUse> {
        Some(stack::stack_use())
    }

    fn brown_out_volts(&self) -> f32 {
        options::BROWN_OUT_VOLTS
    }

    async fn set_brown_out(&mut self) -> Result<(), NotSet> {
        // May stall the processor beyond the normal time-out; only while disarmed.
        watchdog::be_patient(true).await;
        let set = options::set_brown_out();
        watchdog::be_patient(false).await;
        if set { Ok(()) } else { Err(NotSet) }
    }
}
