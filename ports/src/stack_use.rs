//! How deep the board's one stack has been. All levels share it, and one that overflows ends the run with the motors
//! stopped.

use core::fmt::Write;

use heapless::String;

use crate::chip_check::{ChipCheck, READ};

/// Least share of the stack that is to stay unused, parts of it: what no test has reached, such as every level at its
/// deepest at once or a driver's handler of errors, has this room.
const RESERVE: u32 = 4;

/// Names of the rows of [`StackUse`].
pub const AT_START: &str = "stack at start-up";
/// See [`AT_START`].
pub const SINCE: &str = "stack since";

/// Bytes of the stack, and the most that were in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StackUse {
    /// Its size.
    pub bytes: u32,
    /// Greatest depth while the board started.
    pub start: u32,
    /// Greatest depth since.
    pub flight: u32,
}

impl StackUse {
    /// Less than the reserve has stayed unused.
    pub const fn is_scarce(&self) -> bool {
        !self.leaves_reserve(self.start) || !self.leaves_reserve(self.flight)
    }

    /// As a row of what is looked at in the chip.
    pub fn at_start(&self) -> ChipCheck {
        self.look(AT_START, self.start)
    }

    /// See [`Self::at_start`].
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
