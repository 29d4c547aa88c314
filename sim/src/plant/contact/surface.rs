//! What a contact point meets.

use glam::DVec3;

use super::friction::Friction;
use super::pipe::Pipe;

/// A contact surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surface {
    /// The plane z = 0; coefficient of friction.
    Ground(f64),
    /// A pipe.
    Pipe(Pipe),
}

impl Surface {
    /// Depth (m) and outward normal at `point` (m, NED), if inside.
    pub(super) fn probe(&self, point: DVec3) -> Option<(f64, DVec3)> {
        match self {
            Self::Ground(_) => (point.z > 0.0).then_some((point.z, DVec3::NEG_Z)),
            Self::Pipe(pipe) => pipe.probe(point),
        }
    }

    /// Velocity of the surface, m/s, NED.
    pub(super) fn velocity(&self) -> DVec3 {
        match self {
            Self::Ground(_) => DVec3::ZERO,
            Self::Pipe(pipe) => DVec3::new(0.0, 0.0, pipe.shape.heave_speed),
        }
    }

    /// Stiffness (N/m) of a pad of `stiffness` on what lies under it: springs in series.
    pub(super) fn under(&self, stiffness: f64) -> f64 {
        match self {
            Self::Pipe(pipe) if pipe.shape.softness > 0.0 => 1.0 / (1.0 / stiffness + pipe.shape.softness),
            _ => stiffness,
        }
    }

    pub(super) fn friction(&self) -> Friction {
        match self {
            Self::Ground(kinetic) => Friction {
                kinetic: *kinetic,
                static_share: 1.0,
            },
            Self::Pipe(pipe) => Friction {
                kinetic: pipe.friction,
                static_share: pipe.shape.static_share,
            },
        }
    }
}
