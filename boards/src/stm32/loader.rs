//! The chip's boot loader, which receives firmware over USB (ST's AN2606). It is entered by a request that outlives a
//! reset, before clocks, caches and watchdog are on, as it requires. It is left by a reset, since it starts the
//! firmware with its own clocks running: an H7 ignores new dividers of a running PLL, so all rates would be wrong.

use cortex_m::peripheral::SCB;
use embassy_stm32::pac::RCC;
use embassy_stm32::pac::rcc::vals::Sw;

use crate::cortex_m::restart::reset;
use crate::cortex_m::retained::{self, Request, ResetCause};
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
    retained::request(Request::EnterLoader);
    reset()
}

/// Enters the loader if the previous run requested it; resets the chip if it was started by the loader. Called once,
/// before everything else.
pub fn enter_or_leave_loader(cause: ResetCause) {
    let requested = retained::requested(cause);
    if requested == Some(Request::EnterLoader) {
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
    // Once: a chip whose clocks outlived the reset would be reset without end.
    if clocks_run() && requested != Some(Request::GoOn) {
        // The memory is made whole by the cause of this start, which the next does not know.
        let _ = retained::start(cause);
        retained::request(Request::GoOn);
        reset()
    }
}

/// The crystal, a PLL or another core clock than the internal one is on: all are off after a reset (RM0090 §7.3, RM0410
/// §5.3, RM0433 §8.7).
fn clocks_run() -> bool {
    let on = RCC.cr().read();
    #[cfg(family = "h7")]
    let plls = (0..3).any(|pll| on.pllon(pll));
    #[cfg(not(family = "h7"))]
    let plls = on.pllon();
    plls || on.hseon() || RCC.cfgr().read().sws() != Sw::HSI
}
