//! What else ends a run than a hard fault: a panic, an unserved interrupt. How it ends is up to the image
//! ([`ends_with!`](crate::ends_with)): the firmware restarts, a test reports.

use core::panic::PanicInfo;

use cortex_m_rt::exception;
use sophie_fault::end_of_run;

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    end_of_run(format_args!("{info}"))
}

// Also that of the interrupt that cannot be masked (-14), by which the chips tell of a crystal that has stopped.
#[exception]
// SAFETY: only the processor calls it.
unsafe fn DefaultHandler(number: i16) -> ! {
    end_of_run(format_args!("interrupt {number} has no handler"))
}
