//! Whether pressing arms lie round one lengthwise pipe, by their tilts and their tendons' forces.
//!
//! Pressure alone proves no grip: an arm may press on its neighbour, and arms across an oblique pipe on each other. An
//! arm laid round a pipe of radius R is bent by L/R at its tip, at any stiffness. The four tilts have a mean and three
//! differences, each with one cause:
//!
//! | part | cause | limit |
//! |---|---|---|
//! | mean over L/R | another pipe, or none | 0.65 to 1.7: 0.6 to 1.5 times `pipe_diameter` |
//! | left less right | stands beside the crown: 1.5 °/mm on one pad, none on both | 25° |
//! | diagonal | oblique: 4.7 ° per degree at 0.3 m, for the pipe is b tan ψ further off at each pair | 60°: 13° oblique |
//! | front less rear | none on a straight pipe: one arm is elsewhere by twice as much | 15° |

use crate::allocation::wrench::PerArm;
use crate::maths::scalar::deg;

/// Range of the mean tilt, relative to that round the pipe of the parameters.
const SHARE: (f32, f32) = (BENT_MIN, 1.7);
/// Least bending round a pipe that fits, the widest one.
pub const BENT_MIN: f32 = 0.65;
/// Largest half difference of the pairs: left and right, the two diagonals, front and rear, rad.
const BESIDE_MAX: f32 = deg(25.0);
const OBLIQUE_MAX: f32 = deg(60.0);
const STRAY_MAX: f32 = deg(15.0);
/// Largest force of a tendon over the smallest: arms of ±20 % (1.5) 70 mm beside the crown (2.5). The other arms press
/// an arm with a weaker tendon.
const FORCE_RATIO_MAX: f32 = 4.0;
/// Uncertainty of a tendon's force, N: 1 mm of thread at its knot.
const FORCE_UNSURE: f32 = 8.0;

/// Reason for which pressing arms do not hold a pipe.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Misfit {
    /// Bent as round a pipe of another diameter, or round none.
    Thickness,
    /// The pipe does not run lengthwise.
    Oblique,
    /// The pipe lies to one side, or one arm is elsewhere.
    Uneven,
    /// A tendon pulls so little that the other arms press its arm.
    Opposed,
}

/// One closed arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Laid {
    /// Tilt, rad.
    pub tilt: f32,
    /// Force of its tendon minus the share that balances the rotor's thrust, N.
    pub force: f32,
}

/// Misfit of the closed `arms` (`None`: not chosen) round a pipe that bends them by `bend` rad.
pub fn misfit(arms: &PerArm<Option<Laid>>, bend: f32) -> Option<Misfit> {
    let laid = || arms.iter().flatten();
    let count = laid().count() as f32;
    let mean = laid().map(|a| -a.tilt).sum::<f32>() / count;
    // Any NaN is a misfit.
    if !(SHARE.0 * bend..=SHARE.1 * bend).contains(&mean) {
        return Some(Misfit::Thickness);
    }
    let [beside, oblique, stray] = differences(arms);
    let (lengthwise, even) = (oblique <= OBLIQUE_MAX, beside <= BESIDE_MAX && stray <= STRAY_MAX);
    if !lengthwise {
        return Some(Misfit::Oblique);
    }
    if !even {
        return Some(Misfit::Uneven);
    }
    let least = laid().map(|a| a.force).fold(f32::INFINITY, f32::min);
    let allowed = FORCE_RATIO_MAX * (least.max(0.0) + FORCE_UNSURE);
    let opposed = !laid().all(|a| a.force <= allowed);
    opposed.then_some(Misfit::Opposed)
}

/// A proof has become impossible for closing `arms`, pressing or not: an arm that misses the pipe keeps bending, which
/// only increases the difference of the diagonals.
pub fn lies_across(arms: &PerArm<Option<Laid>>) -> bool {
    let [_, oblique, _] = differences(arms);
    oblique > OBLIQUE_MAX
}

/// Half differences of left and right, the diagonals, front and rear, rad; NaN for a set of arms that the pilot cannot
/// choose.
fn differences(arms: &PerArm<Option<Laid>>) -> [f32; 3] {
    let half = |a: f32, b: f32| 0.5 * (a - b).abs();
    match arms.map(|a| a.map(|a| a.tilt)) {
        [Some(a), Some(b), Some(c), Some(d)] => [half(a + b, c + d), half(a + d, b + c), half(a + c, b + d)],
        // With two arms, the offsets beside the crown and oblique give the same difference.
        [Some(a), None, Some(b), None] | [None, Some(a), None, Some(b)] => [0.0, (a - b).abs(), 0.0],
        _ => [f32::NAN, 0.0, 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.178 m of arm round 0.15 m.
    const BEND: f32 = 1.187;

    fn laid(tilts: PerArm<f32>, forces: PerArm<f32>) -> PerArm<Option<Laid>> {
        let mut arms = [None; 4];
        for ((slot, tilt), force) in arms.iter_mut().zip(tilts).zip(forces) {
            *slot = Some(Laid {
                tilt: -deg(tilt),
                force,
            });
        }
        arms
    }

    fn of(tilts: PerArm<f32>, forces: PerArm<f32>) -> Option<Misfit> {
        misfit(&laid(tilts, forces), BEND)
    }

    /// Degrees and N of proofs in the plant at a `pipe_diameter` of 0.3 m.
    #[test]
    fn grips_that_hold_fit() {
        for (what, tilts, forces) in [
            ("crown", [75.0, 67.0, 66.0, 75.0], [39.0, 30.0, 33.0, 40.0]),
            ("45 mm beside", [69.0, 62.0, 72.0, 81.0], [33.0, 27.0, 37.0, 45.0]),
            (
                "70 mm beside, 0.4 m",
                [52.0, 48.0, 63.0, 71.0],
                [21.0, 15.0, 32.0, 39.0],
            ),
            (
                "0.2 m, 5 deg oblique",
                [90.0, 103.0, 103.0, 90.0],
                [50.0, 54.0, 57.0, 51.0],
            ),
            (
                "10 deg oblique",
                [56.0, 89.0, 88.0, 56.0],
                [27.0, 45.0, 48.0, 29.0],
            ),
            (
                "arms of 20 %, 3 deg",
                [71.0, 61.0, 71.0, 87.0],
                [38.0, 25.0, 42.0, 42.0],
            ),
        ] {
            assert_eq!(of(tilts, forces), None, "{what}");
        }
    }

    /// Round pipes of 1.7 and of 0.55 times the diameter: 0.59 and 1.8 times the bend.
    #[test]
    fn a_pipe_of_another_thickness_does_not_fit() {
        let force = [40.0; 4];
        for (bend, fits) in [
            (0.59, false),
            (0.67, true),
            (1.0, true),
            (1.65, true),
            (1.8, false),
        ] {
            let tilt = (bend * BEND).to_degrees();
            let found = of([tilt; 4], force);
            assert_eq!(found, (!fits).then_some(Misfit::Thickness), "{bend}");
        }
    }

    /// Degrees of closings in the plant on a pipe of 0.4 m, 19° oblique, before one arm had found it.
    #[test]
    fn an_oblique_pipe_shows_before_every_arm_presses() {
        for (tilts, across) in [
            ([90.0, 42.0, 14.0, 69.0], false),
            ([108.0, 41.0, 15.0, 73.0], true),
            ([47.0, 114.0, 77.0, 21.0], true),
            ([10.0; 4], false),
        ] {
            assert_eq!(lies_across(&laid(tilts, [20.0; 4])), across, "{tilts:?}");
        }
        let [a, _, c, _] = laid([30.0, 0.0, 95.0, 0.0], [20.0; 4]);
        assert!(lies_across(&[a, None, c, None]) && !lies_across(&[a, None, None, None]));
    }

    #[test]
    fn what_presses_and_holds_no_pipe_is_named() {
        for (what, tilts, forces, why) in [
            ("closed on themselves", [145.0; 4], [90.0; 4], Misfit::Thickness),
            ("on an obstacle", [30.0; 4], [20.0; 4], Misfit::Thickness),
            (
                "one on its neighbour",
                [145.0, 66.0, 66.0, 75.0],
                [90.0, 30.0, 33.0, 40.0],
                Misfit::Uneven,
            ),
            (
                "one stopped early",
                [75.0, 67.0, 25.0, 75.0],
                [39.0, 30.0, 15.0, 40.0],
                Misfit::Uneven,
            ),
            (
                "20 deg oblique",
                [32.0, 94.0, 125.0, 50.0],
                [12.0, 47.0, 72.0, 25.0],
                Misfit::Oblique,
            ),
            (
                "across",
                [100.0, 145.0, 146.0, 101.0],
                [60.0, 112.0, 117.0, 63.0],
                Misfit::Thickness,
            ),
            (
                "beside",
                [95.0, 95.0, 40.0, 40.0],
                [50.0, 50.0, 30.0, 30.0],
                Misfit::Uneven,
            ),
            (
                "one pulls against three",
                [75.0, 67.0, 66.0, 75.0],
                [2.0, 60.0, 33.0, 40.0],
                Misfit::Opposed,
            ),
        ] {
            assert_eq!(of(tilts, forces), Some(why), "{what}");
        }
    }

    #[test]
    fn two_arms_are_judged_by_what_two_show() {
        let front = |a: f32, b: f32| {
            let [first, _, third, _] = laid([a, 0.0, b, 0.0], [40.0; 4]);
            misfit(&[first, None, third, None], BEND)
        };
        assert_eq!(front(75.0, 60.0), None);
        assert_eq!(front(130.0, 40.0), Some(Misfit::Oblique));
        assert_eq!(front(20.0, 40.0), Some(Misfit::Thickness));
    }

    #[test]
    fn what_is_no_number_or_no_pair_fits_nothing() {
        assert_eq!(
            of([f32::NAN, 70.0, 70.0, 70.0], [40.0; 4]),
            Some(Misfit::Thickness)
        );
        assert_eq!(of([70.0; 4], [f32::NAN; 4]), Some(Misfit::Opposed));
        assert_eq!(misfit(&[None; 4], BEND), Some(Misfit::Thickness));
        let [first, second, ..] = laid([70.0; 4], [40.0; 4]);
        assert!(misfit(&[first, second, None, None], BEND).is_some());
    }
}
