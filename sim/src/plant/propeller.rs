//! Distance of the propellers from the pipe.

use glam::DVec3;
use sophie_control::allocation::wrench::PerArm;

use super::contact::{ARM_LENGTH, ArmSkin, Pipe, Pose};

/// Radius of a 10-inch propeller, m.
pub const RADIUS: f64 = 0.127;
/// Disc above the arm's underside at its end, m: arm and motor (assumed).
pub const HEIGHT: f64 = 0.061;
/// Points of the rim that are checked.
const RIM: u32 = 32;

/// Distance of the propeller discs from the surface of an endless pipe, m: negative inside. The arms have tilts `tilt`
/// (rad).
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
        let beside = |point: DVec3| libm::hypot(point.y - pipe.east, point.z - pipe.down);
        let rim = (0..RIM).map(|i| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(RIM));
            centre + cos * along + sin * across
        });
        rim.map(beside).fold(beside(centre), f64::min) - pipe.radius
    })
}

#[cfg(test)]
mod tests {
    use glam::DQuat;

    use super::*;

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
