//! Pulses on a pad, timed by the cycle counter.

use heapless::Vec;

use crate::cycles;
use sophie_boards::{Pad, WIRING};

/// Two DShot frames.
pub const MOST: usize = 32;

/// In core cycles.
#[derive(Clone, Copy, defmt::Format)]
pub struct Pulse {
    /// Rising edge, from the start of the recording.
    pub rise: u32,
    /// Duration.
    pub high: u32,
}

/// Whole pulses on `pad` in the next `us` µs, at most [`MOST`]. Does not yield; without interrupts the error of an edge
/// is some ten cycles.
pub fn record(pad: Pad, us: u32) -> Vec<Pulse, MOST> {
    let length = us * (WIRING.core_hz / 1_000_000);
    let mut pulses = Vec::new();
    let start = cycles::now();
    let mut was_high = pad.is_high();
    // A pulse that has already begun is skipped.
    let mut rise = None;
    loop {
        let high = pad.is_high();
        let now = cycles::now().wrapping_sub(start);
        if high != was_high {
            was_high = high;
            if high {
                rise = Some(now);
            } else if let Some(rise) = rise.take() {
                let high = now - rise;
                if pulses.push(Pulse { rise, high }).is_err() {
                    return pulses;
                }
            }
        }
        if now >= length {
            return pulses;
        }
    }
}
