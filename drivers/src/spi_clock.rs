//! Clock of an SPI, divided by powers of two.

/// Dividers of an STM32's SPI.
const LEAST: u32 = 2;
const MOST: u32 = 256;

/// Fastest clock up to `most_hz`, Hz, of an SPI at `clock_hz`; the slowest if all are faster.
///
/// Must be requested exactly: for an inexact value embassy-stm32 0.6 may take too fast a divider (84 MHz by 8, 10.5
/// MHz, for 8 MHz).
pub fn at_most(clock_hz: u32, most_hz: u32) -> u32 {
    let ratio = clock_hz.div_ceil(most_hz.max(1)).min(MOST);
    clock_hz / ratio.next_power_of_two().max(LEAST)
}

#[cfg(test)]
mod tests {
    use super::at_most;

    #[test]
    fn no_part_is_clocked_above_its_rating() {
        for (clock, most, found) in [
            // H743, F405 with either part, F765.
            (48_000_000, 24_000_000, 24_000_000),
            (84_000_000, 24_000_000, 21_000_000),
            (84_000_000, 8_000_000, 5_250_000),
            (108_000_000, 8_000_000, 6_750_000),
            (100_000_000, 24_000_000, 12_500_000),
            (16_000_000, 24_000_000, 8_000_000),
            (100_000_000, 1, 390_625),
            (100_000_000, 0, 390_625),
        ] {
            assert_eq!(at_most(clock, most), found, "{clock} {most}");
        }
    }
}
