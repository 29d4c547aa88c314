//! The chip: restart, silicon checks, brown-out level, watchdog.

use crate::chip_check::ChipCheck;
use crate::stack_use::StackUse;

/// The brown-out level could not be set: the chip keeps its previous one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotSet;

/// The chip, as the console uses it.
pub trait Chip {
    /// Restarts; stops the motors first. Does not return on a board.
    fn restart(&mut self);

    /// Restarts into the chip's own boot loader; stops the motors first. Does not return on a board.
    fn enter_loader(&mut self);

    /// Name of the board that the firmware was built for.
    fn board(&self) -> &'static str;

    /// Identity of this image: `sophie_image_id` of its words.
    fn build(&self) -> u32;

    /// The checks of the start-up.
    fn checks(&self) -> &[ChipCheck];

    /// Greatest depth of the stack; `None` if unknown.
    fn stack(&self) -> Option<StackUse> {
        None
    }

    /// Supply voltage below which the chip is held in reset, V, after [`Self::set_brown_out`].
    fn brown_out_volts(&self) -> f32;

    /// Sets the brown-out level permanently: it survives power loss and a new firmware. In force from the next start.
    /// May stall the processor for a second: call only while the motors are stopped.
    ///
    /// # Errors
    /// The chip refused it.
    async fn set_brown_out(&mut self) -> Result<(), NotSet>;
}

/// The independent watchdog.
pub trait Watchdog {
    /// Postpones the reset by the watchdog's period.
    fn feed(&mut self);
}
