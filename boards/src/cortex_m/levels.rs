//! The three levels: two interrupt executors above thread mode.
//!
//! | level | runs in | priority | may be delayed by |
//! |---|---|---|---|
//! | flight | an interrupt vector that no driver owns | 6 | drivers' interrupts (at 0, microseconds each) |
//! | steady | a second one | 8 | the flight level; bytes of the MAVLink line and packets of USB (7) |
//! | background | thread mode | none | both |
//!
//! Priorities 0 to 5 are the drivers': an executor there would delay the DMA, data-ready and timer interrupts that it
//! needs. Interrupts that may wait for the flight level, whatever arrives on their line, lie between the levels.

use embassy_stm32::interrupt::Priority;

/// Flight level priority.
pub const FLIGHT: Priority = Priority::P6;
/// Priority of drivers whose interrupts never delay the flight level.
pub const BELOW_FLIGHT: Priority = Priority::P7;
/// Steady level priority.
pub const STEADY: Priority = Priority::P8;

/// Makes two of the board's interrupt vectors the flight and steady level.
///
/// The priority is set before the executor starts: at reset it is the highest.
macro_rules! levels_on {
    ($flight:ident, $steady:ident) => {
        static FLIGHT_LEVEL: embassy_executor::InterruptExecutor = embassy_executor::InterruptExecutor::new();
        static STEADY_LEVEL: embassy_executor::InterruptExecutor = embassy_executor::InterruptExecutor::new();

        #[embassy_stm32::interrupt]
        unsafe fn $flight() {
            // SAFETY: the only poll of this executor, in its vector.
            unsafe { FLIGHT_LEVEL.on_interrupt() }
        }

        #[embassy_stm32::interrupt]
        unsafe fn $steady() {
            // SAFETY: the only poll of this executor, in its vector.
            unsafe { STEADY_LEVEL.on_interrupt() }
        }

        /// Starts the flight and steady level, in this order.
        pub fn start_levels() -> (embassy_executor::SendSpawner, embassy_executor::SendSpawner) {
            use embassy_stm32::interrupt::{self, InterruptExt};
            interrupt::$flight.set_priority($crate::cortex_m::FLIGHT);
            interrupt::$steady.set_priority($crate::cortex_m::STEADY);
            (
                FLIGHT_LEVEL.start(interrupt::$flight),
                STEADY_LEVEL.start(interrupt::$steady),
            )
        }
    };
}
pub(crate) use levels_on;
