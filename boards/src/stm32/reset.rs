//! Reset cause from the chip's register.

use embassy_stm32::pac::RCC;

use crate::cortex_m::retained::ResetCause;

/// Reads and clears the reset cause. Every reset sets the pin's flag, so it counts only alone; a power-on also sets the
/// brown-out flag.
#[cfg(family = "h7")]
pub fn take_reset_cause() -> ResetCause {
    let r = RCC.rsr().read();
    RCC.rsr().modify(|w| w.set_rmvf(true));
    cause(
        r.porrstf(),
        r.borrstf(),
        r.iwdg1rstf() || r.wwdg1rstf(),
        r.sftrstf(),
        r.pinrstf(),
    )
}

/// Reads and clears the reset cause; flags as on the H7.
#[cfg(not(family = "h7"))]
pub fn take_reset_cause() -> ResetCause {
    let r = RCC.csr().read();
    RCC.csr().modify(|w| w.set_rmvf(true));
    cause(
        r.porrstf(),
        r.borrstf(),
        r.wdgrstf() || r.wwdgrstf(),
        r.sftrstf(),
        r.padrstf(),
    )
}

fn cause(power_on: bool, brown_out: bool, watchdog: bool, software: bool, pin: bool) -> ResetCause {
    if power_on {
        ResetCause::PowerOn
    } else if brown_out {
        ResetCause::BrownOut
    } else if watchdog {
        ResetCause::Watchdog
    } else if software {
        ResetCause::Software
    } else if pin {
        ResetCause::Pin
    } else {
        ResetCause::Unknown
    }
}
