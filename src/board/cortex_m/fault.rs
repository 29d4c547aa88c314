//! The end of a run: whatever happens, the motors stop first, then the message is kept, then the chip is reset.
//!
//! A reset, because nothing after a fault can be trusted, and because it is the fastest way to motors that are *told*
//! to stop: the motor task's first act is a frame of zeros. The message is logged at the next start.

use core::fmt;
use core::panic::PanicInfo;

use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};

use super::retained;
use crate::board;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end(format_args!("{info}"))
}

fn end(message: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    board::stop_motors();
    retained::leave(message);
    SCB::sys_reset()
}

#[exception]
// SAFETY: only the processor calls it, with the frame that it stacked.
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    // Configurable fault status, HardFault status, and the address that a bus or memory fault tells (ARMv7-M, B3.2).
    let [cfsr, hfsr, bfar] = [0xE000_ED28, 0xE000_ED2C, 0xE000_ED38_usize].map(|address| {
        // SAFETY: registers of the core, always there and readable without side effects.
        unsafe { (address as *const u32).read_volatile() }
    });
    end(format_args!(
        "hard fault at {:#010x}, called from {:#010x}: CFSR {cfsr:#010x} HFSR {hfsr:#010x} BFAR {bfar:#010x}",
        frame.pc(),
        frame.lr()
    ))
}

#[exception]
// SAFETY: only the processor calls it.
unsafe fn DefaultHandler(number: i16) -> ! {
    end(format_args!("interrupt {number} has no handler"))
}
