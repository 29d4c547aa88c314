//! Place of the pipe as another computer reports it.

use crate::maths::scalar;
use crate::maths::vector::{Quat, Vec3};

/// Steepest pipe that is perched on, sine of its slope: 20°.
const STEEPEST: f32 = 0.34;

/// A place on the pipe, in the axes of the poses.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PipeTarget {
    /// When it was measured, µs.
    pub at_us: u64,
    /// Point on the crown on which the vehicle is to land, m.
    pub crown_position: Vec3,
    /// Heading of the pipe, in either direction, rad; `None` if unknown.
    pub heading: Option<f32>,
}

impl PipeTarget {
    /// The heading of a pipe along the x axis of `q`, rad; `None` for one that is too steep.
    pub fn heading_of(q: Quat) -> Option<f32> {
        let along = q.rotate(Vec3::new(1.0, 0.0, 0.0));
        let horizontal = along.z.abs() <= STEEPEST;
        horizontal.then(|| scalar::atan2(along.y, along.x))
    }

    /// True if every number is finite.
    pub fn is_finite(&self) -> bool {
        self.crown_position.is_finite() && self.heading.is_none_or(f32::is_finite)
    }

    /// The pipe's heading that is nearest to the nose's, rad: a pipe has no front.
    pub fn heading_near(&self, nose: f32) -> Option<f32> {
        let off = scalar::wrap_pi(self.heading? - nose);
        let half = scalar::PI / 2.0;
        let turned = if off > half {
            off - scalar::PI
        } else if off < -half {
            off + scalar::PI
        } else {
            off
        };
        Some(scalar::wrap_pi(nose + turned))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pipe_has_no_front_and_a_steep_one_no_heading() {
        for (pipe, nose, near) in [
            (0.2, 0.0, 0.2),
            (3.0, 0.0, -0.141_59),
            (-1.7, 0.0, 1.441_59),
            (0.1, 3.1, -3.041_59),
        ] {
            let target = PipeTarget {
                heading: Some(pipe),
                ..PipeTarget::default()
            };
            let found = target.heading_near(nose).unwrap();
            assert!(
                scalar::wrap_pi(found - near).abs() < 1e-4,
                "{pipe} {nose}: {found}"
            );
        }
        let heading = PipeTarget::heading_of(Quat::from_euler(0.5, 0.1, 0.7)).unwrap();
        assert!((heading - 0.7).abs() < 1e-3);
        assert_eq!(PipeTarget::heading_of(Quat::from_euler(0.0, 0.5, 0.7)), None);
        assert_eq!(PipeTarget::default().heading_near(1.0), None);
    }
}
