//! Decimal numbers, read and shown. The library's exact conversions take 20 KB of flash; for a parameter's seven digits
//! at most one rounded division is exact as well.

use core::fmt;

/// Largest whole number shown, exact in an `f32`: seven digits, or eight below 1.6777216e7.
const UNITS_MAX: u64 = 1 << 24;
/// 32 bits hold them.
const DIGITS_READ: u32 = 9;
/// The smallest parameters are a few millionths.
const PLACES_MAX: usize = 10;
/// Exact in `f32`.
const POWERS: [f32; PLACES_MAX + 1] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10];
/// Beyond it every number is 0 or too large.
const EXPONENT_MAX: i32 = 60;
/// Shown with a power of ten from here.
const LARGE: f32 = 1e9;
/// Sign, nine digits, point and places.
const TEXT: usize = 24;

/// Reads digits with at most one point, a sign before and an exponent (`e-3`) behind. Correctly rounded for up to seven
/// digits and exponents within ±10, else to a last bit; digits beyond the ninth only count by their place.
///
/// `None` for anything else, including `inf`, `nan` and overflow.
pub fn parse(text: &str) -> Option<f32> {
    let (sign, digits) = match text.as_bytes() {
        [b'-', rest @ ..] => (-1.0, rest),
        [b'+', rest @ ..] => (1.0, rest),
        rest => (1.0, rest),
    };
    let (mut mantissa, mut kept, mut exponent) = (0u32, 0, 0i32);
    let (mut seen, mut point) = (false, false);
    let mut bytes = digits.iter();
    while let Some(&byte) = bytes.next() {
        match byte {
            b'0'..=b'9' => {
                seen = true;
                if kept < DIGITS_READ {
                    mantissa = 10 * mantissa + u32::from(byte - b'0');
                    kept += u32::from(mantissa > 0);
                    exponent -= i32::from(point);
                } else {
                    exponent += i32::from(!point);
                }
            }
            b'.' if !point => point = true,
            b'e' | b'E' if seen => {
                exponent += self::exponent(bytes.as_slice())?;
                break;
            }
            _ => return None,
        }
    }
    if !seen {
        return None;
    }
    let value = sign * scaled(mantissa as f32, exponent);
    value.is_finite().then_some(value)
}

fn exponent(bytes: &[u8]) -> Option<i32> {
    let (sign, digits) = match bytes {
        [b'-', rest @ ..] => (-1, rest),
        [b'+', rest @ ..] => (1, rest),
        rest => (1, rest),
    };
    if digits.is_empty() {
        return None;
    }
    let mut value = 0i32;
    for &byte in digits {
        if !byte.is_ascii_digit() {
            return None;
        }
        value = (10 * value + i32::from(byte - b'0')).min(EXPONENT_MAX);
    }
    Some(sign * value)
}

/// `value` · 10^`exponent`, in one operation where the power is exact.
fn scaled(mut value: f32, exponent: i32) -> f32 {
    let mut left = exponent.unsigned_abs().min(2 * EXPONENT_MAX as u32) as usize;
    while left > 0 && value != 0.0 {
        let step = left.min(PLACES_MAX);
        let power = POWERS.get(step).copied().unwrap_or(1.0);
        value = if exponent < 0 {
            value / power
        } else {
            value * power
        };
        left -= step;
    }
    value
}

/// A number shown with the fewest digits that read back to it, at most seven or eight, or with a precision (`{:.2}`).
#[derive(Clone, Copy, Debug)]
pub struct Decimal(pub f32);

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let magnitude = self.0.abs();
        if !magnitude.is_finite() {
            return f.write_str(if self.0.is_nan() {
                "NaN"
            } else if self.0 > 0.0 {
                "inf"
            } else {
                "-inf"
            });
        }
        if magnitude >= LARGE {
            return large(self.0, f);
        }
        let (mut rest, places) = match f.precision() {
            Some(places) => fixed(magnitude, places.min(PLACES_MAX)),
            None => shortest(magnitude),
        };
        let mut text = Text::new();
        let negative = self.0 < 0.0 && rest > 0;
        let mut written = 0;
        while written <= places || rest > 0 {
            if places > 0 && written == places {
                text.push(b'.');
            }
            text.push(b'0' + (rest % 10) as u8);
            rest /= 10;
            written += 1;
        }
        if negative {
            text.push(b'-');
        }
        // `pad` would cut by the precision.
        match f.width() {
            Some(width) if f.align() != Some(fmt::Alignment::Right) => write!(f, "{:<width$}", text.as_str()),
            Some(width) => write!(f, "{:>width$}", text.as_str()),
            None => f.write_str(text.as_str()),
        }
    }
}

/// Seven digits and a power of ten.
fn large(value: f32, f: &mut fmt::Formatter<'_>) -> fmt::Result {
    let (mut digits, mut exponent) = (value, 0);
    while digits.abs() >= 10.0 {
        digits /= 10.0;
        exponent += 1;
    }
    write!(f, "{}e{exponent}", Decimal(digits))
}

/// `magnitude` (below [`LARGE`]) in units of the last of `places` places, and `places`.
fn fixed(magnitude: f32, places: usize) -> (u64, usize) {
    let power = POWERS.get(places).copied().unwrap_or(1.0);
    ((magnitude * power + 0.5) as u64, places)
}

/// Like [`fixed`], with the fewest places that read back, within seven digits.
fn shortest(magnitude: f32) -> (u64, usize) {
    let mut best = fixed(magnitude, 0);
    for (places, &power) in POWERS.iter().enumerate() {
        let near = (magnitude * power + 0.5) as u64;
        if near > UNITS_MAX {
            break;
        }
        // The product is rounded too: with seven digits its neighbour may be right.
        for units in [near, near + 1, near.saturating_sub(1)] {
            if (units as f32 / power).to_bits() == magnitude.to_bits() {
                return (units, places);
            }
        }
        best = (near, places);
    }
    best
}

/// Text written from its end.
struct Text {
    bytes: [u8; TEXT],
    start: usize,
}

impl Text {
    const fn new() -> Self {
        Self {
            bytes: [0; TEXT],
            start: TEXT,
        }
    }

    fn push(&mut self, byte: u8) {
        if let Some(start) = self.start.checked_sub(1)
            && let Some(slot) = self.bytes.get_mut(start)
        {
            *slot = byte;
            self.start = start;
        }
    }

    fn as_str(&self) -> &str {
        let bytes = self.bytes.get(self.start..).unwrap_or_default();
        core::str::from_utf8(bytes).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::format;
    use std::string::ToString;

    use crate::params::Params;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_are_read_as_the_library_reads_them() {
        for text in [
            "0", "-0", "1", "+1.5", "-2.25", ".5", "5.", "0.00003", "1e3", "1E-3", "12.5e+2", "16777216",
            "8.3", "100000.0", "0.001444", "1e-45", "3.4e38",
        ] {
            let expected: f32 = text.parse().unwrap();
            let got = parse(text).unwrap();
            assert!(
                (got - expected).abs() <= expected.abs() * 3e-7,
                "{text}: {got} {expected}"
            );
        }
    }

    #[test]
    fn what_is_no_number_is_none() {
        for text in [
            "", "-", "+", ".", "e3", "1e", "1e+", "1.2.3", "nan", "inf", "-inf", "0x10", "1 ", " 1", "1,5",
            "--1", "1e99", "4e38", "12a",
        ] {
            assert!(parse(text).is_none(), "{text}: {:?}", parse(text));
        }
        assert_eq!(parse("1e-99"), Some(0.0));
        assert_eq!(parse(&"9".repeat(2000)), None);
        assert_eq!(parse(&format!("0.{}1", "0".repeat(2000))), Some(0.0));
    }

    #[test]
    fn every_parameter_reads_back() {
        for row in Params::TABLE {
            for value in [row.default, row.min, row.max] {
                let text = Decimal(value).to_string();
                assert_eq!(
                    parse(&text).map(f32::to_bits),
                    Some(value.to_bits()),
                    "{} {text}",
                    row.name
                );
                assert_eq!(text, value.to_string(), "{}", row.name);
            }
        }
    }

    #[test]
    fn precision_and_width_are_kept() {
        assert_eq!(format!("{:.2}", Decimal(15.2)), "15.20");
        assert_eq!(format!("{:.1}", Decimal(-0.04)), "0.0");
        assert_eq!(format!("{:.0}", Decimal(1799.6)), "1800");
        assert_eq!(format!("{:<9}|", Decimal(0.05)), "0.05     |");
        assert_eq!(format!("{:>6}", Decimal(-1.5)), "  -1.5");
        assert_eq!(format!("{:.3}", Decimal(0.0005)), "0.001");
        assert_eq!(Decimal(-f32::MAX).to_string(), "-3.402824e38");
        assert_eq!(Decimal(123_456_790.0).to_string(), "123456792");
        assert_eq!(Decimal(2.0 / 3.0).to_string(), "0.6666667");
        assert_eq!(Decimal(f32::NAN).to_string(), "NaN");
        assert_eq!(Decimal(f32::NEG_INFINITY).to_string(), "-inf");
    }

    proptest! {
        #[test]
        fn seven_digits_are_exact_both_ways(mantissa in 0u32..10_000_000, places in 0usize..=10, minus: bool) {
            let sign = if minus { "-" } else { "" };
            let text = format!("{sign}{mantissa}e-{places}");
            let expected: f32 = text.parse().unwrap();
            prop_assert_eq!(parse(&text).map(f32::to_bits), Some(expected.to_bits()));
            let shown = Decimal(expected).to_string();
            let back = parse(&shown).unwrap();
            prop_assert!((back - expected).abs() <= expected.abs() * 1e-6 + 0.5e-10, "{} {}", text, shown);
            if expected.abs() >= 1e-3 {
                prop_assert_eq!(back, expected, "{}", shown);
            }
        }

        #[test]
        fn no_text_is_too_much(text in "\\PC{0,40}") {
            if let Some(value) = parse(&text) {
                prop_assert!(value.is_finite());
            }
        }

        #[test]
        fn every_number_can_be_shown(bits: u32) {
            let value = f32::from_bits(bits);
            let text = Decimal(value).to_string();
            if value.abs() >= 1e-3 && value.is_finite() {
                let back: f32 = text.parse().unwrap();
                prop_assert!((back / value - 1.0).abs() < 4e-6 || value.abs() < 1e3 && (back - value).abs() < 1e-6,
                    "{} {}", value, text);
            }
        }
    }
}
