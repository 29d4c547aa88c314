//! The boards: all code specific to a chip, and all unsafe code that flies.
//!
//! A board is one file: clocks, pins, DMA streams and timers, claimed with `assign_resources`, and `Board`'s ports.
//! Several boards share `stm32`, all share `cortex_m`; both depend on the chip's family, never on the board. The build
//! script picks the memory map in `memory/`. `sophie-fault` ends a run. The host only has the check of a board's pins
//! (`output_pins`).

#![cfg_attr(target_os = "none", no_std)]
#![cfg_attr(
    target_os = "none",
    allow(
        unsafe_code,
        reason = "registers, vectors and linker symbols; each use has its reason beside it"
    )
)]

#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod cortex_m;
#[cfg(not(target_os = "none"))]
pub mod output_pins;
#[cfg(target_os = "none")]
mod stm32;

#[cfg(target_os = "none")]
pub use board::*;
#[cfg(all(target_os = "none", feature = "trace"))]
pub use cortex_m::trace;
#[cfg(target_os = "none")]
pub use cortex_m::{end::stop_and_restart, retained, retained::ResetCause, stack};
#[cfg(target_os = "none")]
pub use sophie_fault::ends_with;
#[cfg(target_os = "none")]
pub use stm32::{
    BufferedInput, BufferedOutput, GroundLine, MAVLINK_BYTES_PER_SECOND, Pad, Pupdr, ReceiverLine, Taken,
    TelemetryLine, ThisChip, USB_BYTES_PER_SECOND, UsbDriver, UsbPort, WatchdogPort, Wiring,
    enter_or_leave_loader, restart, stop_with_core, take_reset_cause,
};
