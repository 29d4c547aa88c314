//! What ends a run: a panic, a fault of the processor, an interrupt that nobody serves. How it ends is up to the image
//! (`crate::end_of_run`): the firmware restarts, a test reports.

use core::panic::PanicInfo;

use cortex_m_rt::{ExceptionFrame, exception};

use crate::end_of_run;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end_of_run(format_args!("{info}"))
}

#[exception]
// SAFETY: only the processor calls it, with the frame that it stacked.
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // Configurable fault status, HardFault status, and the address that a bus or memory fault tells (ARMv7-M, B3.2).
    let [cfsr, hfsr, bfar] = [0xE000_ED28, 0xE000_ED2C, 0xE000_ED38_usize].map(|address| {
        // SAFETY: registers of the core, always there and readable without side effects.
        unsafe { (address as *const u32).read_volatile() }
    });
    end_of_run(format_args!(
        "hard fault at {:#010x}, called from {:#010x}: CFSR {cfsr:#010x} HFSR {hfsr:#010x} BFAR {bfar:#010x}",
        frame.pc(),
        frame.lr()
    ))
}

#[exception]
// SAFETY: only the processor calls it.
unsafe fn DefaultHandler(number: i16) -> ! {
    end_of_run(format_args!("interrupt {number} has no handler"))
}
