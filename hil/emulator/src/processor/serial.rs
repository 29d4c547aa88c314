//! Settings of a serial port, read from its registers and checked: the emulator itself carries words at any rate, level
//! and polarity.

use std::fmt::{self, Display, Formatter};

use sophie_control::params::RcProtocol;

use crate::board_kind::Kind;

/// Tolerance of an asynchronous line.
const RATE_ERROR: f64 = 0.02;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setup {
    /// Rate, baud.
    pub rate: f64,
    pub parity: bool,
    pub two_stops: bool,
    /// Idle is low.
    pub inverted: bool,
    /// A sample a bit, so that no noise is flagged.
    pub one_sample: bool,
}

impl Setup {
    /// Required settings of the MAVLink line.
    pub const MAVLINK: Self = Self::plain(57_600.0);
    /// Required settings of the line to the flow and range module.
    pub const GROUND: Self = Self::plain(115_200.0);

    /// 8N1 at `rate` baud.
    const fn plain(rate: f64) -> Self {
        Self {
            rate,
            parity: false,
            two_stops: false,
            inverted: false,
            one_sample: false,
        }
    }

    /// Required settings of a board's receiver line.
    pub fn of(protocol: RcProtocol, board: Kind) -> Self {
        match protocol {
            RcProtocol::Crsf => Self {
                one_sample: true,
                ..Self::plain(420e3)
            },
            RcProtocol::Sbus => Self {
                rate: 100e3,
                parity: true,
                two_stops: true,
                // The F4's ports cannot invert: the board does.
                inverted: board == Kind::MatekH743,
                one_sample: false,
            },
        }
    }

    /// From `BRR` and `CR1` to `CR3` of a port clocked at `clock` Hz. The parts share the fields (RM0090 §30.6, RM0433
    /// §48.8), but the F4 lacks bit 16 of `CR2`.
    pub fn in_registers(clock: f64, [brr, cr1, cr2, cr3]: [u64; 4]) -> Self {
        let oversampled_by_8 = cr1 >> 15 & 1 == 1;
        Self {
            rate: clock * if oversampled_by_8 { 2.0 } else { 1.0 } / (brr.max(1) as f64),
            // Enabled, and not odd.
            parity: cr1 >> 9 & 3 == 2,
            two_stops: cr2 >> 12 & 3 == 2,
            inverted: cr2 >> 16 & 1 == 1,
            one_sample: cr3 >> 11 & 1 == 1,
        }
    }

    /// The two settings can communicate.
    pub fn fits(&self, other: &Self) -> bool {
        (other.rate / self.rate - 1.0).abs() < RATE_ERROR
            && Self {
                rate: self.rate,
                ..*other
            } == *self
    }
}

impl Display for Setup {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let parity = if self.parity { 'E' } else { 'N' };
        let stops = 1 + u8::from(self.two_stops);
        let inverted = if self.inverted { " inverted" } else { "" };
        let samples = if self.one_sample { ", one sample a bit" } else { "" };
        write!(f, "{:.0} baud 8{parity}{stops}{inverted}{samples}", self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_registers_tell_the_set_up() {
        let sbus = Setup::of(RcProtocol::Sbus, Kind::MatekH743);
        let found = Setup::in_registers(100e6, [1000, 1 << 12 | 1 << 10, 2 << 12 | 1 << 16, 0]);
        assert!(sbus.fits(&found), "{found}");
        assert_eq!(found.to_string(), "100000 baud 8E2 inverted");
        assert!(!sbus.fits(&Setup::in_registers(100e6, [1000, 1 << 12 | 1 << 10, 2 << 12, 0])));
        assert!(!sbus.fits(&Setup::in_registers(
            100e6,
            [1050, 1 << 12 | 1 << 10, 2 << 12 | 1 << 16, 0]
        )));
        let crsf = Setup::of(RcProtocol::Crsf, Kind::F405);
        assert!(crsf.fits(&Setup::in_registers(84e6, [200, 0, 0, 1 << 11])));
        assert!(!crsf.fits(&Setup::in_registers(84e6, [200, 0, 0, 0])));
        assert!(!crsf.fits(&found));
    }
}
