//! Errors of a pose from a square tag at the perch spot.
//!
//! A corner that is off by σ pixels of a camera with the focal length f (pixels) puts the camera at the distance d beside
//! its place by d σ/f, and, since the tag of edge s is f s/d pixels wide, along the line of sight by d · d σ/(f s); the
//! attitude errs by the latter's share, d σ/(f s). At 3 m, with 0.15 m: 1.5 mm, 30 mm, 0.6°; tags have 20 to 50 mm.
//!
//! A planar tag has two poses that project nearly alike (Schweighofer and Pinz, 2006; Collins and Bartoli, 2014). The wrong
//! one mirrors the line of sight about the tag's normal, here up: it turns the vehicle about the tag by twice the angle
//! between them, to the other side of the spot. Straight above both are one.

use crate::normal::StandardNormal;
use glam::{DQuat, DVec3};
use rand::Rng;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use crate::plant::contact::Pose;
use crate::streams::Streams;

/// Error of a corner over the focal length, rad: 0.3 of 600 pixels (assumed).
const CORNER: f64 = 0.3 / 600.0;

/// The tag and its errors.
#[derive(Clone, Debug)]
pub struct Tag {
    rng: Pcg64Mcg,
    /// NED, m.
    place: DVec3,
    /// Edge, m; `None`: no error but the outliers.
    size: Option<f64>,
    /// Share of the poses that are the other one.
    outliers: f64,
}

/// Error of one pose, world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TagError {
    /// To be added to the position, m.
    pub offset: DVec3,
    /// To be multiplied to the attitude from the left.
    pub turn: DQuat,
}

impl Tag {
    /// A tag at `place` (m, NED) with an edge of `size` m, of whose poses the share `outliers` are mirrored.
    #[must_use]
    pub fn new(place: DVec3, size: Option<f64>, outliers: f64, streams: Streams) -> Self {
        Self {
            rng: streams.of("pose.tag"),
            place,
            size,
            outliers,
        }
    }

    /// Error of a pose of the vehicle.
    pub fn error(&mut self, pose: &Pose) -> TagError {
        let from = pose.position - self.place;
        let distance = from.length();
        let sight = from.normalize_or(DVec3::NEG_Z);
        let mut error = TagError {
            offset: DVec3::ZERO,
            turn: DQuat::IDENTITY,
        };
        if self.outliers > 0.0 && self.rng.random::<f64>() < self.outliers {
            error.turn = mirrored(sight);
            error.offset = error.turn * from - from;
        }
        if let Some(size) = self.size {
            let share = distance * CORNER / size;
            let mut normal =
                || DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(&mut self.rng)));
            let (across, turned) = (normal(), normal());
            let along = across.dot(sight);
            error.offset +=
                (across - sight * along) * (distance * CORNER) + sight * (along * distance * share);
            error.turn = DQuat::from_scaled_axis(turned * share) * error.turn;
        }
        error
    }
}

/// Turns `sight`, the direction from the tag, to the other side of the vertical, which it leans from by as much.
fn mirrored(sight: DVec3) -> DQuat {
    let other = DVec3::new(-sight.x, -sight.y, sight.z);
    DQuat::from_rotation_arc(sight, other)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: DVec3) -> Pose {
        Pose {
            position,
            attitude: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            omega: DVec3::ZERO,
        }
    }

    const PLACE: DVec3 = DVec3::new(3.0, 0.0, -1.5);

    /// RMS of the errors across, along the line of sight (m), and of the angle (rad) over 2,000 poses `distance` m above.
    fn noise(distance: f64) -> [f64; 3] {
        let mut tag = Tag::new(PLACE, Some(0.15), 0.0, Streams::new(2));
        let pose = at(PLACE - DVec3::Z * distance);
        let mut sum = [0.0; 3];
        for _ in 0..2000 {
            let TagError { offset, turn } = tag.error(&pose);
            let angle = turn.to_scaled_axis().x;
            for (sum, error) in sum.iter_mut().zip([offset.x, offset.z, angle]) {
                *sum += error * error / 2000.0;
            }
        }
        sum.map(f64::sqrt)
    }

    #[test]
    fn noise_grows_with_the_distance_and_along_the_line_of_sight_with_its_square() {
        for (distance, wanted) in [(1.0, [0.5e-3, 3.33e-3, 3.33e-3]), (3.0, [1.5e-3, 30e-3, 10e-3])] {
            for (rms, wanted) in noise(distance).into_iter().zip(wanted) {
                assert!(
                    (rms / wanted - 1.0).abs() < 0.08,
                    "{distance}: {rms} for {wanted}"
                );
            }
        }
    }

    #[test]
    fn an_outlier_is_on_the_other_side_of_the_spot_and_leans_by_twice_the_angle() {
        let mut tag = Tag::new(PLACE, None, 1.0, Streams::new(2));
        let beside = PLACE + DVec3::new(0.0, 0.5, -2.0);
        let TagError { offset, turn } = tag.error(&at(beside));
        assert!(
            (beside + offset - (PLACE + DVec3::new(0.0, -0.5, -2.0))).length() < 1e-9,
            "{offset}"
        );
        let angle = turn.to_scaled_axis().length();
        assert!((angle - 2.0 * libm::atan(0.25_f64)).abs() < 1e-9, "{angle}");
        let TagError { offset, turn } = tag.error(&at(PLACE - DVec3::Z));
        assert!(offset.length() < 1e-9 && turn.to_scaled_axis().length() < 1e-9);
        // Without outliers and size there is no error.
        let mut none = Tag::new(PLACE, None, 0.0, Streams::new(2));
        assert_eq!(none.error(&at(beside)).offset, DVec3::ZERO);
    }
}
