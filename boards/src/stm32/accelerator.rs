//! The F4's flash accelerator, which embassy-stm32 0.6 switches off when it sets the wait states: five at each branch
//! and constant cost a third to a half of the speed.

use embassy_stm32::pac::{DBGMCU, FLASH};

/// Its prefetch must stay off (STM32F405 errata, "ART accelerator prefetch").
const REVISION_A: u16 = 0x1000;

/// Prefetch is usable.
pub fn has_prefetch() -> bool {
    DBGMCU.idcode().read().rev_id() != REVISION_A
}

/// Invalidates and enables both caches; enables the prefetch on revisions that support it. Called once, after the
/// clocks.
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

/// Runs `change`, which writes or erases flash, with the data cache off, and empties it: otherwise a verifying read
/// would return old data (RM0090 §3.5.2).
pub fn uncached<T>(change: impl FnOnce() -> T) -> T {
    FLASH.acr().modify(|w| w.set_dcen(false));
    let result = change();
    for reset in [true, false] {
        FLASH.acr().modify(|w| w.set_dcrst(reset));
    }
    FLASH.acr().modify(|w| w.set_dcen(true));
    result
}

/// State of prefetch, instruction cache and data cache.
pub fn enabled() -> [bool; 3] {
    let r = FLASH.acr().read();
    [r.prften(), r.icen(), r.dcen()]
}
