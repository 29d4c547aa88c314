//! The F4's flash accelerator. embassy-stm32 0.6 sets the wait states by a write that switches it off: five wait states
//! at each branch and each constant, which costs a third to a half of the speed.

use embassy_stm32::pac::{DBGMCU, FLASH};

/// Revision A: its prefetch must stay off (STM32F405 errata, "ART accelerator prefetch").
const REVISION_A: u16 = 0x1000;

/// The prefetch may be used.
pub fn has_prefetch() -> bool {
    DBGMCU.idcode().read().rev_id() != REVISION_A
}

/// Switches both caches on, empty, and the prefetch where it works. Called once, when the clocks run.
pub fn enable() {
    let caches = |on| {
        FLASH.acr().modify(|w| {
            w.set_icen(on);
            w.set_dcen(on);
        });
    };
    caches(false);
    // The reset bits take effect while the caches are off (RM0090 §3.9.2).
    for reset in [true, false] {
        FLASH.acr().modify(|w| {
            w.set_icrst(reset);
            w.set_dcrst(reset);
        });
    }
    FLASH.acr().modify(|w| w.set_prften(has_prefetch()));
    caches(true);
}

/// Does `change`, which writes or erases flash, with the data cache off and empties it: it does not see such changes, and
/// what is read back to verify would be what was there before (RM0090 §3.5.2).
pub fn uncached<T>(change: impl FnOnce() -> T) -> T {
    FLASH.acr().modify(|w| w.set_dcen(false));
    let result = change();
    for reset in [true, false] {
        FLASH.acr().modify(|w| w.set_dcrst(reset));
    }
    FLASH.acr().modify(|w| w.set_dcen(true));
    result
}

/// Prefetch, instruction cache and data cache are on.
pub fn enabled() -> [bool; 3] {
    let r = FLASH.acr().read();
    [r.prften(), r.icen(), r.dcen()]
}
