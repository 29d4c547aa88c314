//! Pressure of the air, as a board's barometer measures it.

/// Range of a board's barometer, Pa: that of both parts that boards carry (DPS310, 300 to 1,200 hPa).
pub const PASCAL: (f32, f32) = (30_000.0, 120_000.0);
/// Temperature of such a part, °C: its rated range.
pub const CELSIUS: (f32, f32) = (-40.0, 85.0);

/// Pressure of the air around the board.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AirPressure {
    /// Middle of the measurement, µs.
    pub at_us: u64,
    /// Pa.
    pub pascal: f32,
    /// Temperature of the part, which is warmer than the air, °C.
    pub celsius: f32,
}

impl AirPressure {
    /// The sample; `None` if pressure or temperature is not finite or outside [`PASCAL`] and [`CELSIUS`].
    pub fn checked(self) -> Option<Self> {
        let within = |x: f32, (least, most): (f32, f32)| (least..=most).contains(&x);
        (within(self.pascal, PASCAL) && within(self.celsius, CELSIUS)).then_some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_number_or_cannot_be_is_no_pressure() {
        let sound = AirPressure {
            at_us: 1,
            pascal: 101_325.0,
            celsius: 31.0,
        };
        assert_eq!(sound.checked(), Some(sound));
        for pascal in [
            f32::NAN,
            f32::INFINITY,
            -f32::INFINITY,
            0.0,
            29_999.0,
            120_001.0,
            -101_325.0,
        ] {
            assert_eq!(AirPressure { pascal, ..sound }.checked(), None, "{pascal}");
        }
        for celsius in [f32::NAN, f32::INFINITY, -41.0, 86.0] {
            assert_eq!(AirPressure { celsius, ..sound }.checked(), None, "{celsius}");
        }
    }
}
