//! Frees an I2C bus whose data line a chip holds low.
//!
//! A chip that loses its master in the middle of a byte, by a reset or by noise, keeps holding the bit that it was
//! about to give, and no start condition gets through any more. Clocks take the rest of the byte from it: nine are
//! enough whatever it was doing, and a stop ends the transfer (UM10204, §3.1.16).

use embassy_time::Timer;
use embedded_hal::digital::{InputPin, OutputPin};

/// Half a clock, µs: 100 kHz, which every chip takes.
const HALF_CLOCK_US: u64 = 5;
/// Clocks after which nothing that still sends is an I2C chip.
const CLOCKS: u8 = 9;
/// Halves of a clock for which a chip may stretch one: 1 ms.
const STRETCH: u8 = 200;

/// What became of the lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lines {
    /// Both were high: nothing was done.
    Idle,
    /// The data line was held and came free after this many clocks.
    Freed(u8),
    /// A line stays low: a short circuit, or a chip without power.
    Held,
}

/// Frees the bus with the lines `clock` and `data`, which are open drains with pull-ups. Takes 0.3 ms at most, or 10 ms
/// with a chip that stretches every clock; yields all the while.
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

/// Data rises while the clock is high.
async fn stop<L: InputPin + OutputPin>(clock: &mut L, data: &mut L) {
    pull(clock).await;
    pull(data).await;
    rises(clock).await;
    release(data).await;
}

/// Lets the clock go and waits until no chip stretches it any more; false when it never rises.
async fn rises<L: InputPin + OutputPin>(clock: &mut L) -> bool {
    for _ in 0..STRETCH {
        release(clock).await;
        if is_high(clock) {
            return true;
        }
    }
    false
}

// A pin of the chip itself does not fail.
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
