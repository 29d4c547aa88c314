//! Checks the frequency ranges of the PLLs. The emulator's PLLs lock at any frequency, real ones do not.

/// Clock registers: `CR`, `PLLCKSELR`, `PLLCFGR` and each PLL's `DIVR`.
pub struct Settings {
    pub control: u64,
    pub dividers: u64,
    pub ranges: u64,
    pub multipliers: [u64; 3],
}

/// Limits of the input ranges, MHz (RM0433 §8.7.12).
const INPUTS: [[f64; 2]; 4] = [[1.0, 2.0], [2.0, 4.0], [4.0, 8.0], [8.0, 16.0]];
/// Wide and medium oscillator, MHz (RM0433 §8.5.5, datasheet of revision V).
const WIDE: [f64; 2] = [192.0, 836.0];
const MEDIUM: [f64; 2] = [150.0, 420.0];

/// The first enabled PLL outside its range, sourced with `hz`.
pub fn wrong(settings: &Settings, hz: f64) -> Option<String> {
    (0..3).find_map(|nth| one(settings, nth, hz * 1e-6).map(|what| format!("PLL{}: {what}", nth + 1)))
}

fn one(settings: &Settings, nth: usize, mhz: f64) -> Option<String> {
    if settings.control >> (24 + 2 * nth) & 1 == 0 {
        return None;
    }
    let divider = settings.dividers >> (4 + 8 * nth) & 0x3F;
    let reference = mhz / divider.max(1) as f64;
    let made = reference * ((settings.multipliers[nth] & 0x1FF) + 1) as f64;
    let range = settings.ranges >> (4 * nth);
    let [input, medium] = [(range >> 2 & 3) as usize, (range >> 1 & 1) as usize];
    let outside = |value: f64, [least, most]: [f64; 2]| value < least || value > most;
    let complaint = |what: &str, value: f64, [least, most]: [f64; 2]| {
        Some(format!(
            "{what} {value:.0} MHz, its range is {least:.0} to {most:.0}"
        ))
    };
    let oscillator = if medium == 1 { MEDIUM } else { WIDE };
    if outside(reference, INPUTS[input]) {
        complaint("reference", reference, INPUTS[input])
    } else if medium == 1 && outside(reference, INPUTS[0]) {
        complaint("reference of the medium oscillator", reference, INPUTS[0])
    } else if outside(made, oscillator) {
        complaint("oscillator", made, oscillator)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first(divider: u64, multiplier: u64, input: u64, medium: u64) -> Option<String> {
        let settings = Settings {
            control: 1 << 24,
            dividers: divider << 4,
            ranges: input << 2 | medium << 1,
            multipliers: [multiplier - 1, 0, 0],
        };
        wrong(&settings, 8e6)
    }

    #[test]
    fn a_pll_outside_its_range_is_reported() {
        assert_eq!(first(1, 100, 3, 0), None);
        assert_eq!(first(4, 100, 1, 0), None);
        for ((divider, multiplier, input, medium), complaint) in [
            // A former setting: 200 MHz of the medium oscillator, from 8 MHz.
            (
                (1, 25, 3, 1),
                "PLL1: reference of the medium oscillator 8 MHz, its range is 1 to 2",
            ),
            ((1, 100, 1, 0), "PLL1: reference 8 MHz, its range is 2 to 4"),
            (
                (1, 120, 3, 0),
                "PLL1: oscillator 960 MHz, its range is 192 to 836",
            ),
            ((4, 50, 0, 1), "PLL1: oscillator 100 MHz, its range is 150 to 420"),
        ] {
            assert_eq!(
                first(divider, multiplier, input, medium).as_deref(),
                Some(complaint)
            );
        }
        let off = Settings {
            control: 0,
            dividers: 0,
            ranges: 0,
            multipliers: [0; 3],
        };
        assert_eq!(wrong(&off, 8e6), None);
    }
}
