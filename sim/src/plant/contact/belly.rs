//! The belly pads.

use glam::DVec3;

use super::{BELLY, BELLY_Z, ContactPoint, Pad, PointMotion, Pose, Surface};

/// Load on the body alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyLoad {
    /// Force, N, body.
    pub force_body: DVec3,
    /// Moment about the centre of mass, N·m, body.
    pub moment_body: DVec3,
    /// Normal force on each pad, in the order of [`Belly::PADS`], N.
    pub normal: [f64; 4],
}

/// The four belly pads against one surface.
#[derive(Clone, Debug)]
pub struct Belly {
    points: [ContactPoint; 4],
    pad: Pad,
}

impl Default for Belly {
    fn default() -> Self {
        Self {
            points: Default::default(),
            pad: BELLY,
        }
    }
}

impl Belly {
    /// Body positions, m.
    pub const PADS: [DVec3; 4] = [
        DVec3::new(0.10, -0.03, BELLY_Z),
        DVec3::new(-0.10, -0.03, BELLY_Z),
        DVec3::new(0.10, 0.03, BELLY_Z),
        DVec3::new(-0.10, 0.03, BELLY_Z),
    ];

    /// The same that rebounds as [`rebound`](super::rebound) says.
    #[must_use]
    pub fn rebounding(self, rebound: f64) -> Self {
        Self {
            pad: self.pad.rebounding(rebound),
            ..self
        }
    }

    /// Advances by `dt` s.
    pub fn step(&mut self, dt: f64, pose: &Pose, surface: &Surface) -> BodyLoad {
        let mut load = BodyLoad::default();
        let pads = self.points.iter_mut().zip(Self::PADS);
        for ((point, r), normal) in pads.zip(&mut load.normal) {
            let velocity = pose.point_velocity(r, DVec3::ZERO);
            let touch = point.force(
                dt,
                &self.pad,
                PointMotion {
                    position: pose.point(r),
                    velocity,
                },
                surface,
            );
            let force = pose.to_body(touch.force);
            load.force_body += force;
            load.moment_body += r.cross(force);
            *normal = touch.normal;
        }
        load
    }
}
