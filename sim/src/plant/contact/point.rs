//! One contact point: the normal force of its spring and damper, and its friction.

use glam::DVec3;

use super::friction::Bristle;
use super::{Pad, Surface, restitution};

/// Contact load of a point.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// Force on the vehicle, N, NED.
    pub force: DVec3,
    /// Normal part, N.
    pub normal: f64,
    /// Depth, m.
    pub depth: f64,
}

/// Motion of a point, NED.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion {
    /// Position, m.
    pub position: DVec3,
    /// Velocity, m/s.
    pub velocity: DVec3,
}

/// A contact point with its bristle, and the speed at which it began to touch.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactPoint {
    bristle: Bristle,
    /// m/s into the surface; `None` while it is free.
    touched: Option<f64>,
}

impl ContactPoint {
    /// Advances by `dt` s.
    pub fn force(&mut self, dt: f64, pad: &Pad, motion: PointMotion, surface: &Surface) -> Touch {
        let PointMotion { position, velocity } = motion;
        let Some((depth, n)) = surface.probe(position) else {
            *self = Self::default();
            return Touch::default();
        };
        let velocity = velocity - surface.velocity();
        let along = velocity.dot(n);
        let touched = *self.touched.get_or_insert(-along);
        let stiffness = surface.under(pad.stiffness);
        let normal = if pad.rebound > 0.0 {
            restitution::force(pad.rebound, stiffness, depth, -along, touched)
        } else {
            (stiffness * depth - pad.resting_damping(depth) * along).max(0.0)
        };
        let slip = velocity - n * along;
        let tangential = self.bristle.step(dt, pad, &surface.friction(), n, normal, slip);
        Touch {
            force: n * normal + tangential,
            normal,
            depth,
        }
    }
}
