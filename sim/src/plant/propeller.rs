//! Distances of the propeller discs from the pipe and from the vehicle's own arms, which bend under them.
//!
//! The arms are arcs here, tip tilt alone. A thrust bends an arm near its root, under the disc less than an arc, so that
//! the distance from it is somewhat larger than this one.

use glam::DVec3;
use sophie_control::allocation::wrench::PerArm;

use super::contact::{ARM_LENGTH, ArmSkin, HINGE_Z, Pipe, Pose, UNDERSIDE_Z};

/// Radius of a 10-inch propeller, m.
pub const RADIUS: f64 = 0.127;
/// Disc above the arm's underside at its end, m: arm and motor (assumed).
pub const HEIGHT: f64 = 0.061;
/// Points of the rim that are checked.
const RIM: u32 = 32;
/// Height of an arm, m: twice its neutral line's over the underside, the same along its length (assumed).
const ARM_HEIGHT: f64 = 2.0 * (UNDERSIDE_Z - HINGE_Z);
/// Points of an arm that are checked, from its root to the motor's edge.
const ALONG: u32 = 16;
/// Radius of the motor, on which the propeller stands, m.
const MOTOR: f64 = 0.014;

/// Distance of each propeller disc from the upper side of its own arm, m: negative where the arm reaches through it. The arms
/// have tilts `tilt` (rad).
#[must_use]
pub fn own_arm(tilt: PerArm<f64>) -> PerArm<f64> {
    std::array::from_fn(|arm| {
        let skin = ArmSkin::new(arm);
        let up = |share: f64| {
            let (sin, cos) = libm::sincos(tilt[arm] * share);
            DVec3::new(0.0, -skin.point(0.0, ARM_LENGTH).0.y.signum() * sin, -cos)
        };
        let centre = skin.point(tilt[arm], ARM_LENGTH).0 + HEIGHT * up(1.0);
        let reach = 1.0 - MOTOR / ARM_LENGTH;
        (0..=ALONG)
            .map(|i| {
                let share = reach * f64::from(i) / f64::from(ALONG);
                let top = skin.point(tilt[arm], share * ARM_LENGTH).0 + ARM_HEIGHT * up(share);
                let from = top - centre;
                let below = -from.dot(up(1.0));
                let beside = (from + up(1.0) * below).length() - RADIUS;
                if beside <= 0.0 {
                    below
                } else {
                    libm::hypot(beside, below)
                }
            })
            .fold(f64::INFINITY, f64::min)
    })
}

/// Distance of the propeller discs from the surface of the pipe, m: negative inside. The arms have tilts `tilt` (rad).
#[must_use]
pub fn clearance(pose: &Pose, tilt: PerArm<f64>, pipe: &Pipe) -> PerArm<f64> {
    std::array::from_fn(|arm| {
        let skin = ArmSkin::new(arm);
        let (tip, _) = skin.point(tilt[arm], ARM_LENGTH);
        let side = tip.y.signum();
        let (sin, cos) = libm::sincos(tilt[arm]);
        // Along the arm at its end, and out of its upper side; body axes.
        let out = DVec3::new(0.0, side * cos, -sin);
        let up = DVec3::new(0.0, -side * sin, -cos);
        let centre = pose.point(tip + HEIGHT * up);
        let [along, across] = [DVec3::X, out].map(|axis| RADIUS * (pose.attitude * axis));
        let rim = (0..RIM).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(RIM));
            centre + cos * along + sin * across
        });
        let gap = |point| pipe.gap(point);
        rim.map(gap).fold(gap(centre), f64::min)
    })
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;
    use crate::plant::contact::PipeShape;

    /// Level, its centre of mass 1 m over the ground.
    fn level() -> Pose {
        Pose {
            position: DVec3::new(0.0, 0.0, -1.0),
            attitude: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            omega: DVec3::ZERO,
        }
    }

    fn pipe(east: f64, down: f64) -> Pipe {
        Pipe {
            north: 0.0,
            half_length: 1.0,
            east,
            down,
            radius: 0.15,
            friction: 0.6,
            shape: PipeShape::STRAIGHT,
        }
    }

    fn is_right(arm: usize) -> bool {
        ArmSkin::new(arm).point(0.0, 0.1).0.y > 0.0
    }

    #[test]
    fn level_arms_hold_their_discs_over_a_pipe_by_the_height_of_the_motors() {
        // The pipe's top touches the arms' underside, below the motors of one side in turn.
        for east in [0.178, -0.178] {
            let clear = clearance(&level(), [0.0; 4], &pipe(east, -1.0 + 0.035 + 0.15));
            for arm in 0..4 {
                if is_right(arm) == (east > 0.0) {
                    assert!((clear[arm] - HEIGHT).abs() < 1e-6, "{arm}: {clear:?}");
                } else {
                    assert!(clear[arm] > HEIGHT + 0.05, "{arm}: {clear:?}");
                }
            }
        }
    }

    /// Level, 31 mm lie between disc and arm; at the curvature that raises the arm by as much under the rim, 31 mm · 2 / (127
    /// mm)², the tip leans by 39 degrees.
    #[test]
    fn an_arm_that_bends_up_reaches_into_its_own_disc() {
        let level = own_arm([0.0; 4]);
        assert!(
            level
                .iter()
                .all(|clear| (clear - (HEIGHT - ARM_HEIGHT)).abs() < 1e-9),
            "{level:?}"
        );
        let [at_30, at_45, at_80, down] = own_arm([30.0, 45.0, 80.0, -70.0].map(f64::to_radians));
        assert!(
            at_30 > 2e-3 && at_45 < -2e-3 && at_80 < at_45,
            "{at_30} {at_45} {at_80}"
        );
        assert!((down - level[3]).abs() < 0.01, "{down}");
    }

    #[test]
    fn beyond_the_end_of_a_pipe_there_is_none() {
        let beyond = Pipe {
            north: 5.0,
            ..pipe(0.178, -1.0)
        };
        assert_eq!(clearance(&level(), [0.0; 4], &beyond), [f64::INFINITY; 4]);
    }

    #[test]
    fn a_pipe_in_the_disc_is_a_negative_clearance() {
        let clear = clearance(&level(), [0.0; 4], &pipe(0.178, -1.0 + 0.035 - HEIGHT));
        for arm in 0..4 {
            assert_eq!(clear[arm] < -0.1, is_right(arm), "{arm}: {clear:?}");
        }
    }

    /// Rolled right side down, the right discs come nearer, and bending the arms up takes them away again.
    #[test]
    fn lean_and_tilt_have_their_signs() {
        let beside = pipe(0.35, -0.8);
        let flat = clearance(&level(), [0.0; 4], &beside);
        let leaning = Pose {
            attitude: DQuat::from_rotation_x(0.3),
            ..level()
        };
        let leant = clearance(&leaning, [0.0; 4], &beside);
        let bent = clearance(&leaning, [0.3; 4], &beside);
        let right = (0..4).find(|&arm| is_right(arm)).unwrap();
        assert!(leant[right] < flat[right] - 0.02, "{leant:?} {flat:?}");
        assert!(bent[right] > leant[right] + 0.02, "{bent:?} {leant:?}");
    }
}
