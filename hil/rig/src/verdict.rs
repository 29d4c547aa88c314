//! The end of a test.

use core::fmt;

use defmt::Display2Format;

/// Reports a missing part or jumper `what`, with its place. The test then has no result.
///
/// # Panics
/// With the feature `wired`, where everything must be present.
pub fn absent(what: fmt::Arguments<'_>) {
    if cfg!(feature = "wired") {
        panic!("not found: {what}");
    }
    defmt::warn!("ignored: not found: {}", Display2Format(&what));
}

/// Passes a test after its reset, when the probe no longer waits for its return.
pub fn passed() -> ! {
    semihosting::process::exit(0)
}

/// A panic or fault ends the test without a reset of the chip: the motors stop and the probe gets the verdict.
pub fn end_of_run(message: fmt::Arguments<'_>) -> ! {
    cortex_m::interrupt::disable();
    sophie_boards::stop_motors();
    defmt::error!("{}", Display2Format(&message));
    semihosting::process::abort()
}
