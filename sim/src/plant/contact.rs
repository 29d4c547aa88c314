//! Contact with ground and pipe.
//!
//! Points in body axes (FRD, origin at the centre of mass): spring and damper along the normal, push only; a bristle
//! along the surface that sticks up to Coulomb's limit. Loads are force and moment on the body, body axes, and moment
//! on the arm's tilt α. Stiffnesses are those of soft printed parts (assumed), stable with semi-implicit steps of 0.5
//! ms.

mod arm_skin;
mod belly;
pub(crate) mod friction;
mod pad;
pub mod pipe;
mod point;
mod restitution;
mod surface;

use glam::{DQuat, DVec3};

pub use self::arm_skin::{ArmSkin, ArmTip, SkinLoad};
pub use self::belly::{Belly, BodyLoad};
pub use self::pad::{BELLY, Pad, SKIN, TIP};
pub use self::pipe::{Pipe, PipeShape};
pub use self::point::{ContactPoint, PointMotion, Touch};
pub use self::restitution::rebound;
pub use self::surface::Surface;

/// Belly pads below the centre of mass, m, body z (assumed).
pub const BELLY_Z: f64 = 0.04;
/// Arms' underside at the root, m, body z: 5 mm above the belly pads (assumed), about their indentation beside a crown.
pub const UNDERSIDE_Z: f64 = 0.035;
/// Arms' neutral line at the hinge, m, body z (assumed).
pub const HINGE_Z: f64 = 0.02;
/// Arm from the centre line to the rotor, m.
pub const ARM_LENGTH: f64 = 0.178;
/// Arms from the centre of mass along body x, m.
pub const ARM_X: f64 = 0.178;
/// Contact points of the skin, m from the arm's root along it; the pressure sensor is at the last.
pub const STATIONS: [f64; 3] = [0.06, 0.11, 0.16];
/// Width and length, m.
const STATION_SIZE: (f64, f64) = (0.03, 0.05);
/// Station area, m².
pub const STATION_AREA: f64 = STATION_SIZE.0 * STATION_SIZE.1;
/// Pressure over indentation, Pa/m (assumed: TPU of 6 to 10 % infill with a foam patch).
pub const SKIN_STIFFNESS: f64 = 5.0e5;

/// Pose and motion of the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of mass, NED, m.
    pub position: DVec3,
    /// Body to world.
    pub attitude: DQuat,
    /// Velocity of the centre of mass, NED, m/s.
    pub velocity: DVec3,
    /// Angular rate, body, rad/s.
    pub omega: DVec3,
}

impl Pose {
    /// World position of `r`, body.
    pub fn point(&self, r: DVec3) -> DVec3 {
        self.position + self.attitude * r
    }

    /// World velocity of the body point `r` that moves at `relative`, body axes.
    pub fn point_velocity(&self, r: DVec3, relative: DVec3) -> DVec3 {
        self.velocity + self.attitude * (self.omega.cross(r) + relative)
    }

    /// World to body axes.
    pub fn to_body(&self, world: DVec3) -> DVec3 {
        self.attitude.conjugate() * world
    }
}

#[cfg(test)]
mod tests;
