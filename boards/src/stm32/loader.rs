//! The chip's own loader, which takes a firmware over USB (ST's AN2606): entered by a request that outlives a reset, before
//! clocks, caches or watchdog are on, as it expects its chip.

use cortex_m::peripheral::SCB;

use crate::cortex_m::restart::reset;
use crate::cortex_m::retained::{self, ResetCause};
use crate::stop_motors;

/// Its vector table in system memory (AN2606; on the H7 the loader begins within it).
#[cfg(family = "f4")]
const LOADER: u32 = 0x1FFF_0000;
#[cfg(family = "f7")]
const LOADER: u32 = 0x1FF0_0000;
#[cfg(family = "h7")]
const LOADER: u32 = 0x1FF0_9800;

/// Resets into the loader, motors stopped first.
pub fn leave_for_loader() -> ! {
    stop_motors();
    retained::ask_for_loader();
    reset()
}

/// Enters the loader where the run before has asked for it. Called first of all, once.
pub fn enter_loader_if_asked(cause: ResetCause) {
    if retained::loader_asked_for(cause) {
        // SAFETY: the chip is as a reset left it, but for the memory and the outputs' first levels: no interrupt is on,
        // and nothing of this firmware runs again before the next reset. The vector table is there in every chip of the
        // family.
        unsafe {
            (*SCB::PTR).vtor.write(LOADER);
            cortex_m::asm::dsb();
            cortex_m::asm::isb();
            cortex_m::asm::bootload(LOADER as *const u32)
        }
    }
}
