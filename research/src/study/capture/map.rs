//! Counts and half-widths of touches.

use super::{Flown, GAUGES, Gauge, Outcome};

/// Share of the touches within a half-width that may fail.
const MISSED: f64 = 0.01;
/// Offset within which the pressure of closings is limited, m.
pub const NEAR: f64 = 0.045;

/// Number of `flown` that ended with `outcome`.
#[must_use]
pub fn count(flown: &[Flown], outcome: Outcome) -> usize {
    flown.iter().filter(|f| f.outcome == outcome).count()
}

/// The largest offset (m) within which 99 % of the touches, to either side, `succeeded`; 0 without any.
#[must_use]
pub fn half_width<'a>(flown: impl Iterator<Item = &'a Flown>, succeeded: impl Fn(Outcome) -> bool) -> f64 {
    let mut by_offset: Vec<(f64, bool)> = flown
        .map(|f| (f.planned.touch.offset.abs(), succeeded(f.outcome)))
        .collect();
    by_offset.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut failures, mut half_width) = (0, 0.0);
    for (i, (offset, success)) in by_offset.iter().enumerate() {
        failures += u32::from(!success);
        if *success && f64::from(failures) <= MISSED * (i + 1) as f64 {
            half_width = *offset;
        }
    }
    half_width
}

/// The results on one pipe.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// The pipe.
    pub gauge: Gauge,
    /// Touches on it.
    pub touches: usize,
    /// Half-width of 99 % held, m.
    pub held: f64,
    /// Half-width of 99 % held and let go, m.
    pub releasable: f64,
}

/// The half-widths on each of [`GAUGES`].
#[must_use]
pub fn measure(flown: &[Flown]) -> [Measured; GAUGES.len()] {
    std::array::from_fn(|i| {
        let of = || flown.iter().filter(move |f| f.planned.gauge == Some(i));
        Measured {
            gauge: GAUGES[i],
            touches: of().count(),
            held: half_width(of(), Outcome::is_held),
            releasable: half_width(of(), |outcome| outcome == Outcome::Released),
        }
    })
}

/// Extremes of all touches.
#[derive(Clone, Copy, Debug)]
pub struct Extremes {
    /// Deepest below the height of the touch, m.
    pub drop: f64,
    /// Seed of that touch.
    pub deepest_seed: Option<u64>,
    /// Least distance of a turning propeller from the pipe, m.
    pub clearance: f64,
    /// Touches in which one reached the pipe.
    pub strikes: usize,
    /// Largest true pressure in closings that ended in proof, Pa.
    pub closing_pressure: f64,
    /// The same of touches within [`NEAR`], Pa.
    pub near_closing_pressure: f64,
    /// Seed of the touch with that pressure; none where no grip was proven within [`NEAR`].
    pub near_closing_seed: Option<u64>,
    /// Largest true pressure on open arms, Pa.
    pub bump: f64,
    /// Largest true pressure of any touch, Pa.
    pub pressure: f64,
}

/// The extremes of `flown`.
#[must_use]
pub fn extremes(flown: &[Flown]) -> Extremes {
    let touched = || flown.iter().map(|f| f.touched);
    let near = flown
        .iter()
        .filter(|f| f.touched.proven && f.planned.touch.offset.abs() <= NEAR)
        .max_by(|a, b| a.touched.closing_pressure.total_cmp(&b.touched.closing_pressure));
    let deepest = flown
        .iter()
        .max_by(|a, b| a.touched.drop.total_cmp(&b.touched.drop));
    Extremes {
        drop: deepest.map_or(0.0, |f| f.touched.drop),
        deepest_seed: deepest.map(|f| f.planned.touch.seed),
        clearance: touched().map(|t| t.clearance).fold(f64::INFINITY, f64::min),
        strikes: touched().filter(|t| t.clearance <= 0.0).count(),
        closing_pressure: touched()
            .filter(|t| t.proven)
            .map(|t| t.closing_pressure)
            .fold(0.0, f64::max),
        near_closing_pressure: near.map_or(0.0, |f| f.touched.closing_pressure),
        near_closing_seed: near.map(|f| f.planned.touch.seed),
        bump: touched().map(|t| t.bump).fold(0.0, f64::max),
        pressure: touched().map(|t| t.pressure).fold(0.0, f64::max),
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Planned, Touched, plan};
    use super::*;
    use crate::study::touch::End;
    use sophie_control::mode::Mode;

    fn at(offset: f64, outcome: Outcome) -> Flown {
        let Planned { mut touch, .. } = plan(1, 1, 0.0);
        touch.offset = offset;
        Flown {
            planned: Planned {
                touch,
                gauge: Some(0),
            },
            touched: Touched {
                end: End::Released,
                drop: 0.0,
                lean: 0.0,
                pressure: 0.0,
                bump: 0.0,
                escaped: false,
                closed: true,
                proven: true,
                closing_pressure: 0.0,
                clearance: 0.1,
                mode: Mode::Flight,
                why: None,
            },
            outcome,
        }
    }

    /// 200 touches to either side up to 100 mm, held up to 40 mm, but for those `missed`.
    fn map(missed: &[usize]) -> Vec<Flown> {
        (0..200)
            .map(|i| {
                let side = if i % 2 == 0 { 1.0 } else { -1.0 };
                let held = i < 80 && !missed.contains(&i);
                let outcome = if held {
                    Outcome::Released
                } else {
                    Outcome::FlownAway
                };
                at(side * 0.0005 * (i + 1) as f64, outcome)
            })
            .collect()
    }

    #[test]
    fn a_sharp_edge_is_the_half_width() {
        let width = half_width(map(&[]).iter(), Outcome::is_held);
        assert!((width - 0.040).abs() < 1e-9, "{width}");
    }

    #[test]
    fn a_miss_near_the_crown_ends_it_there() {
        // One of the first eighty is more than one in a hundred wherever the edge is drawn beyond it.
        let width = half_width(map(&[30]).iter(), Outcome::is_held);
        assert!((width - 0.015).abs() < 1e-9, "{width}");
    }

    #[test]
    fn one_in_a_hundred_may_miss() {
        let mut flown = map(&[30]);
        flown.extend((0..60).map(|i| at(1e-6 * f64::from(i), Outcome::Released)));
        let width = half_width(flown.iter(), Outcome::is_held);
        assert!((width - 0.040).abs() < 1e-9, "{width}");
    }

    #[test]
    fn pressures_of_near_closings_of_all_and_of_open_arms_stand_apart() {
        let mut flown = vec![
            at(-0.044, Outcome::Released),
            at(0.046, Outcome::Held),
            at(0.0, Outcome::FlownAway),
        ];
        for (f, (closing, bump)) in flown
            .iter_mut()
            .zip([(1100.0, 0.0), (1300.0, 0.0), (1400.0, 2000.0)])
        {
            (f.touched.closing_pressure, f.touched.bump) = (closing, bump);
            f.touched.pressure = f64::max(closing, bump);
        }
        flown[2].touched.proven = false;
        let most = extremes(&flown);
        let found = [
            most.near_closing_pressure,
            most.closing_pressure,
            most.bump,
            most.pressure,
        ];
        assert_eq!(found, [1100.0, 1300.0, 2000.0, 2000.0]);
        let seeds = [7, 8, 9];
        for (f, seed) in flown.iter_mut().zip(seeds) {
            f.planned.touch.seed = seed;
        }
        assert_eq!(extremes(&flown).near_closing_seed, Some(7));
        assert_eq!(extremes(&flown[1..]).near_closing_seed, None);
        flown[1].touched.drop = 0.3;
        assert_eq!(extremes(&flown).deepest_seed, Some(8));
        assert!((extremes(&flown).drop - 0.3).abs() < 1e-12);
    }

    #[test]
    fn nothing_held_is_no_width() {
        assert!(half_width([].iter(), Outcome::is_held).abs() < 1e-12);
        let none = [at(0.0, Outcome::Held)];
        assert!(half_width(none.iter(), |o| o == Outcome::Released).abs() < 1e-12);
    }
}
