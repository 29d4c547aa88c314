//! Frames that report no motion: over dark ground without texture in the sun a PMW3901 reports zeros while it moves (PX4,
//! pull requests 28632 and 28648, issues 10465 and 12894: black pavement at noon), with a quality that does not show it. Of
//! real ones a shiny floor with a true factor of 0.2 had 64 to 96, and a carpet from near 86 to 98.
//!
//! | | | source |
//! |---|---|---|
//! | largest share of zero frames | 0.9 | 0.5 to 0.9 reported |
//! | contrast without zero frames | 0.3 | assumed |
//! | light from which they are in full | 50,000 lux | assumed: half of noon |
//! | least light | 60 lux | the maker's table of the MTF-02 |

const LARGEST: f64 = 0.9;
const TEXTURED: f64 = 0.3;
const SUN: f64 = 50e3;
/// Light below which the flow sees nothing, lux.
pub const DARK: f64 = 60.0;
/// Least and largest quality of a flow whose quality varies.
pub const QUALITIES: (u8, u8) = (40, 200);

/// Probability that a frame of mean `contrast` reports no motion at `light` lux.
#[must_use]
pub fn probability(contrast: f64, light: f64) -> f64 {
    LARGEST * (1.0 - contrast / TEXTURED).max(0.0) * (light / SUN).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bare_ground_in_the_sun_has_zero_frames() {
        for (contrast, light, wanted) in [
            (0.0, 100e3, 0.9),
            (0.1, 100e3, 0.6),
            (0.3, 100e3, 0.0),
            (0.0, 500.0, 0.009),
        ] {
            let p = probability(contrast, light);
            assert!((p - wanted).abs() < 1e-9, "{contrast} {light}: {p}");
        }
        assert_eq!(probability(1.0, 130e3), 0.0);
    }
}
