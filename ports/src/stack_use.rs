//! Greatest depth of the board's one stack. All levels share it, and an overflow ends the run with the motors stopped.

use core::fmt::Write;

use heapless::String;

use crate::chip_check::{ChipCheck, READ};

/// Share of the stack that must stay unused, as its inverse: room for depths that no test has reached, such as every
/// level at its deepest at once or a driver's error handler.
const RESERVE: u32 = 4;

/// Name of the row for the start-up.
pub const AT_START: &str = "stack at start-up";
/// Name of the row for the time since.
pub const SINCE: &str = "stack since";

/// Size of the stack and its greatest depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StackUse {
    /// Size, bytes.
    pub bytes: u32,
    /// Greatest depth while the board started, bytes.
    pub start: u32,
    /// Greatest depth since then, bytes.
    pub flight: u32,
}

impl StackUse {
    /// Less than the reserve has stayed unused.
    pub const fn is_scarce(&self) -> bool {
        !self.leaves_reserve(self.start) || !self.leaves_reserve(self.flight)
    }

    /// The depth at start-up, as a row of the chip's checks.
    pub fn at_start(&self) -> ChipCheck {
        self.look(AT_START, self.start)
    }

    /// The depth since start-up, as a row of the chip's checks.
    pub fn in_flight(&self) -> ChipCheck {
        self.look(SINCE, self.flight)
    }

    const fn leaves_reserve(&self, used: u32) -> bool {
        used <= self.bytes - self.bytes / RESERVE
    }

    fn look(&self, name: &'static str, used: u32) -> ChipCheck {
        let mut read = String::<READ>::new();
        let _ = write!(read, "{used} of {} bytes", self.bytes);
        ChipCheck {
            name,
            read,
            expected: "a quarter left",
            ok: self.leaves_reserve(used),
            inhibits: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stack_is_scarce_below_a_quarter_left_at_any_time() {
        for (start, flight, marks) in [
            (30_000, 40_000, [true, true]),
            (49_152, 49_152, [true, true]),
            (49_156, 40_000, [false, true]),
            (30_000, 49_156, [true, false]),
            (65_536, 65_536, [false, false]),
        ] {
            let used = StackUse {
                bytes: 65_536,
                start,
                flight,
            };
            let checks = [used.at_start(), used.in_flight()];
            assert_eq!(checks.each_ref().map(|look| look.ok), marks, "{used:?}");
            assert_eq!(used.is_scarce(), marks != [true, true], "{used:?}");
            let read = checks[0].read.strip_suffix(" of 65536 bytes");
            assert_eq!(read.map(str::parse), Some(Ok(start)));
        }
    }
}
