//! The chip: restart, silicon checks, brown-out level, watchdog.

use crate::chip_check::ChipCheck;
use crate::stack_use::StackUse;

/// The brown-out level could not be set: the chip keeps what it had.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotSet;

/// The chip itself, as the console sees it.
pub trait Chip {
    /// Restarts, motors stopped first. Does not return on a board.
    fn restart(&mut self);

    /// Restarts into the chip's own loader, motors stopped first. Does not return on a board.
    fn enter_loader(&mut self);

    /// Name of the board that the firmware was built for.
    fn board(&self) -> &'static str;

    /// What tells this image from every other: `sophie_image_id` of its words.
    fn build(&self) -> u32;

    /// Checks of the start-up.
    fn checks(&self) -> &[ChipCheck];

    /// How deep its stack has been; `None` where that is not known.
    fn stack(&self) -> Option<StackUse> {
        None
    }

    /// The supply voltage below which the chip is held in reset, V, once [`Self::set_brown_out`] has been done.
    fn brown_out_volts(&self) -> f32;

    /// Sets the brown-out level for good: it outlives power and every firmware. In force from the next start on. May
    /// stall the processor for a second: only while the motors stand still.
    ///
    /// # Errors
    /// The chip did not take it.
    async fn set_brown_out(&mut self) -> Result<(), NotSet>;
}

/// The independent watchdog.
pub trait Watchdog {
    /// Puts off the reset by the watchdog's period.
    fn feed(&mut self);
}
