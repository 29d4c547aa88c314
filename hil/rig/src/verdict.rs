//! How a test ends.

use core::fmt;

use defmt::Display2Format;

/// A part or a jumper that a test wants is not there: `what`, and where it belongs. The test then has nothing to say.
///
/// # Panics
/// With the feature `wired`, where everything must be there.
pub fn absent(what: fmt::Arguments<'_>) {
    if cfg!(feature = "wired") {
        panic!("not found: {what}");
    }
    defmt::warn!("ignored: not found: {}", Display2Format(&what));
}

/// Ends a test well that a reset cut in two: the probe no longer waits for its return.
pub fn passed() -> ! {
    semihosting::process::exit(0)
}

/// A panic or a fault ends the test, not the chip: the motors stop and the probe gets the verdict.
pub fn end_of_run(message: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    sophie_boards::stop_motors();
    defmt::error!("{}", Display2Format(&message));
    semihosting::process::abort()
}
