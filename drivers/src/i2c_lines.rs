//! Frees an I2C bus whose data line a chip holds low.
//!
//! A chip that loses its master within a byte, by a reset or noise, holds its bit, which blocks start conditions. Nine
//! clocks take the rest of any byte, a stop ends the transfer (UM10204, §3.1.16).

use embassy_time::Timer;
use embedded_hal::digital::{InputPin, OutputPin};

/// Half a clock, µs: 100 kHz, accepted by every chip.
const HALF_CLOCK_US: u64 = 5;
/// Clocks after which every chip has stopped sending.
const CLOCKS: u8 = 9;
/// Clock halves that a chip may stretch: 1 ms.
const STRETCH: u8 = 200;

/// State of the lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lines {
    /// Both high.
    Idle,
    /// Freed after this many clocks.
    Freed(u8),
    /// A line stays low: short circuit or unpowered chip.
    Held,
}

/// Frees the bus of the open drains `clock` and `data` with pull-ups. Takes at most 0.3 ms, or 10 ms if a chip
/// stretches every clock; yields throughout.
pub async fn free<L: InputPin + OutputPin>(clock: &mut L, data: &mut L) -> Lines {
    release(data).await;
    if !rises(clock).await {
        return Lines::Held;
    }
    if is_high(data) {
        return Lines::Idle;
    }
    for clocks in 1..=CLOCKS {
        pull(clock).await;
        if !rises(clock).await {
            return Lines::Held;
        }
        if is_high(data) {
            stop(clock, data).await;
            return if is_high(data) {
                Lines::Freed(clocks)
            } else {
                Lines::Held
            };
        }
    }
    Lines::Held
}

/// Stop condition: data rises while the clock is high.
async fn stop<L: InputPin + OutputPin>(clock: &mut L, data: &mut L) {
    pull(clock).await;
    pull(data).await;
    rises(clock).await;
    release(data).await;
}

/// Releases the clock; false if it never rises.
async fn rises<L: InputPin + OutputPin>(clock: &mut L) -> bool {
    for _ in 0..STRETCH {
        release(clock).await;
        if is_high(clock) {
            return true;
        }
    }
    false
}

// The processor's own pin does not fail.
async fn pull(line: &mut impl OutputPin) {
    let _ = line.set_low();
    Timer::after_micros(HALF_CLOCK_US).await;
}

async fn release(line: &mut impl OutputPin) {
    let _ = line.set_high();
    Timer::after_micros(HALF_CLOCK_US).await;
}

fn is_high(line: &mut impl InputPin) -> bool {
    line.is_high().unwrap_or(false)
}
