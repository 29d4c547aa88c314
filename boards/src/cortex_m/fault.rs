//! Ends of a run other than a hard fault: panic, unserved interrupt. The image defines the end
//! ([`ends_with!`](crate::ends_with)): the firmware restarts, a test reports.

use core::panic::PanicInfo;

use cortex_m_rt::exception;
use sophie_fault::end_of_run;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end_of_run(format_args!("{info}"))
}

// Includes the non-maskable interrupt (-14), which reports a stopped crystal.
#[exception]
// SAFETY: only the processor calls it.
unsafe fn DefaultHandler(number: i16) -> ! {
    end_of_run(format_args!("interrupt {number} has no handler"))
}
