//! Contact with ground and pipe.
//!
//! Points in body axes (FRD, origin at the centre of mass): spring and damper along the normal, push only; a bristle
//! along the surface that sticks up to Coulomb's limit. Loads are force and moment on the body, body axes, and moment
//! on the arm's tilt α. Stiffnesses are those of soft printed parts (assumed), stable with semi-implicit steps of 0.5
//! ms.

use glam::{DQuat, DVec2, DVec3};
use sophie_control::allocation::wrench::{FORE, SIDE};

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

/// A straight north-south pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pipe {
    /// Middle of the pipe, north, m.
    pub north: f64,
    /// Half length, m; may be infinite.
    pub half_length: f64,
    /// Axis, east, m.
    pub east: f64,
    /// Axis, down, m (negative above the ground).
    pub down: f64,
    /// Outer radius, m.
    pub radius: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

impl Pipe {
    /// Distance from `from` along `direction` (in its lengths) to the pipe or the ground, world axes; `None` for a ray
    /// into the sky.
    #[must_use]
    pub fn or_ground_along(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let ground = (direction.z > 1e-3).then(|| -from.z / direction.z);
        [self.along(from, direction), ground]
            .into_iter()
            .flatten()
            .filter(|way| *way > 0.0)
            .min_by(f64::total_cmp)
    }

    fn along(&self, from: DVec3, direction: DVec3) -> Option<f64> {
        let (y, z) = (from.y - self.east, from.z - self.down);
        let (a, b, c) = (
            direction.y * direction.y + direction.z * direction.z,
            y * direction.y + z * direction.z,
            y * y + z * z - self.radius * self.radius,
        );
        let root = b * b - a * c;
        let way = (-b - root.max(0.0).sqrt()) / a;
        let along = (from.x + direction.x * way - self.north).abs();
        (root >= 0.0 && way > 0.0 && along <= self.half_length).then_some(way)
    }
}

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
    fn probe(&self, point: DVec3) -> Option<(f64, DVec3)> {
        match self {
            Self::Ground(_) => (point.z > 0.0).then_some((point.z, DVec3::NEG_Z)),
            Self::Pipe(p) => {
                let across = DVec2::new(point.y - p.east, point.z - p.down);
                let distance = across.length();
                let depth = p.radius - distance;
                if depth <= 0.0 || (point.x - p.north).abs() > p.half_length {
                    return None;
                }
                let n = if distance > 1e-6 {
                    across / distance
                } else {
                    DVec2::new(0.0, -1.0)
                };
                Some((depth, DVec3::new(0.0, n.x, n.y)))
            }
        }
    }

    fn friction(&self) -> f64 {
        match self {
            Self::Ground(friction) => *friction,
            Self::Pipe(pipe) => pipe.friction,
        }
    }
}

/// Springs and dampers of a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pad {
    /// Stiffness along the normal, N/m.
    pub stiffness: f64,
    /// Damping along the normal, N·s/m; full from [`FULL_DAMPING_DEPTH`].
    pub damping: f64,
    /// Stiffness of the bristle along the surface, N/m.
    pub bristle: f64,
    /// Damping of the bristle along the surface, N·s/m.
    pub bristle_damping: f64,
}

/// Depth from which a contact damps in full, m: no step at the touch.
pub const FULL_DAMPING_DEPTH: f64 = 1e-3;

/// A quarter of the vehicle per belly pad: 15 Hz, damping ratio 0.5.
pub const BELLY: Pad = Pad {
    stiffness: 4.0e3,
    damping: 42.0,
    bristle: 4.0e3,
    bristle_damping: 42.0,
};
/// A station of an arm's underside.
pub const SKIN: Pad = Pad {
    stiffness: SKIN_STIFFNESS * STATION_SIZE.0 * STATION_SIZE.1,
    damping: 8.0,
    bristle: 400.0,
    bristle_damping: 4.0,
};
/// Tip of 77 g: 22 Hz, damping ratio 0.5, no friction.
pub const TIP: Pad = Pad {
    stiffness: 1.5e3,
    damping: 10.0,
    bristle: 0.0,
    bristle_damping: 0.0,
};

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

/// A contact point with its bristle's deflection.
#[derive(Clone, Copy, Debug, Default)]
pub struct ContactPoint {
    bristle: DVec3,
}

impl ContactPoint {
    /// Advances by `dt` s.
    pub fn force(&mut self, dt: f64, pad: &Pad, motion: PointMotion, surface: &Surface) -> Touch {
        let PointMotion { position, velocity } = motion;
        let Some((depth, n)) = surface.probe(position) else {
            self.bristle = DVec3::ZERO;
            return Touch::default();
        };
        let along = velocity.dot(n);
        let damping = pad.damping * (depth / FULL_DAMPING_DEPTH).min(1.0);
        let normal = (pad.stiffness * depth - damping * along).max(0.0);

        let slip = velocity - n * along;
        let mut deflection = self.bristle + slip * dt;
        deflection -= n * deflection.dot(n);
        let limit = surface.friction() * normal;
        let mut tangential = -(deflection * pad.bristle + slip * pad.bristle_damping);
        if tangential.length() > limit {
            tangential *= limit / tangential.length();
            // Sliding keeps the deflection that friction can hold.
            if deflection.length() * pad.bristle > limit {
                deflection *= limit / (deflection.length() * pad.bristle);
            }
        }
        self.bristle = deflection;
        Touch {
            force: n * normal + tangential,
            normal,
            depth,
        }
    }
}

/// Load on the body alone.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BodyLoad {
    /// Force, N, body.
    pub force_body: DVec3,
    /// Moment about the centre of mass, N·m, body.
    pub moment_body: DVec3,
    /// Sum of normal forces, N.
    pub normal: f64,
}

/// Load of an arm's contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinLoad {
    /// Force on the vehicle, N, body.
    pub force_body: DVec3,
    /// Moment about the centre of mass, N·m, body.
    pub moment_body: DVec3,
    /// Moment on the arm's tilt, N·m: force · ∂r/∂α.
    pub moment_alpha: f64,
    /// Sensor pressure, Pa.
    pub pressure: f64,
}

/// The four belly pads against one surface.
#[derive(Clone, Debug, Default)]
pub struct Belly {
    points: [ContactPoint; 4],
}

impl Belly {
    /// Body positions, m.
    pub const PADS: [DVec3; 4] = [
        DVec3::new(0.10, -0.03, BELLY_Z),
        DVec3::new(-0.10, -0.03, BELLY_Z),
        DVec3::new(0.10, 0.03, BELLY_Z),
        DVec3::new(-0.10, 0.03, BELLY_Z),
    ];

    /// Advances by `dt` s.
    pub fn step(&mut self, dt: f64, pose: &Pose, surface: &Surface) -> BodyLoad {
        let mut load = BodyLoad::default();
        for (point, r) in self.points.iter_mut().zip(Self::PADS) {
            let velocity = pose.point_velocity(r, DVec3::ZERO);
            let touch = point.force(
                dt,
                &BELLY,
                PointMotion {
                    position: pose.point(r),
                    velocity,
                },
                surface,
            );
            let force = pose.to_body(touch.force);
            load.force_body += force;
            load.moment_body += r.cross(force);
            load.normal += touch.normal;
        }
        load
    }
}

/// Underside of one arm on the pipe.
#[derive(Clone, Debug)]
pub struct ArmSkin {
    side: f64,
    x: f64,
    stations: [ContactPoint; 3],
}

impl ArmSkin {
    /// Skin of arm `arm`, 0 to 3.
    ///
    /// # Panics
    /// Beyond 3.
    pub fn new(arm: usize) -> Self {
        Self {
            side: -f64::from(SIDE[arm]),
            x: ARM_X * f64::from(FORE[arm]),
            stations: Default::default(),
        }
    }

    /// Body position (m) of the point `s` m along the underside at tilt `alpha` rad, and its derivative by α (m/rad),
    /// on an arc of constant curvature, level at its root, at α at its end.
    pub fn point(&self, alpha: f64, s: f64) -> (DVec3, DVec3) {
        let u = alpha * s / ARM_LENGTH;
        let (y, z, dy, dz) = if u.abs() < 1e-3 {
            // Series of the expressions below, which lose digits near a straight arm.
            let q = s * s / ARM_LENGTH;
            (
                s * (1.0 - u * u / 6.0),
                0.5 * s * u,
                -q * u / 3.0,
                q * (0.5 - u * u / 8.0),
            )
        } else {
            let (sin, cos) = libm::sincos(u);
            let radius = ARM_LENGTH / alpha;
            (
                radius * sin,
                radius * (1.0 - cos),
                (s * cos - radius * sin) / alpha,
                (s * sin - radius * (1.0 - cos)) / alpha,
            )
        };
        (
            DVec3::new(self.x, self.side * y, UNDERSIDE_Z - z),
            DVec3::new(0.0, self.side * dy, -dz),
        )
    }

    /// Advances by `dt` s at tilt (rad) and rate (rad/s).
    pub fn step(&mut self, dt: f64, alpha: f64, alpha_rate: f64, pose: &Pose, pipe: &Pipe) -> SkinLoad {
        let mut load = SkinLoad::default();
        let mut stations = self.stations;
        for (station, s) in stations.iter_mut().zip(STATIONS) {
            let (r, by_alpha) = self.point(alpha, s);
            let velocity = pose.point_velocity(r, by_alpha * alpha_rate);
            let touch = station.force(
                dt,
                &SKIN,
                PointMotion {
                    position: pose.point(r),
                    velocity,
                },
                &Surface::Pipe(*pipe),
            );
            let force = pose.to_body(touch.force);
            load.force_body += force;
            load.moment_body += r.cross(force);
            load.moment_alpha += force.dot(by_alpha);
            // The last station's remains: the sensor is there.
            load.pressure = touch.normal / STATION_AREA;
        }
        self.stations = stations;
        load
    }
}

/// Tip of one arm on the ground, without friction.
#[derive(Clone, Debug)]
pub struct ArmTip {
    side: f64,
    x: f64,
    point: ContactPoint,
}

impl ArmTip {
    /// Tip of arm `arm`, 0 to 3.
    ///
    /// # Panics
    /// Beyond 3.
    pub fn new(arm: usize) -> Self {
        let ArmSkin { side, x, .. } = ArmSkin::new(arm);
        Self {
            side,
            x,
            point: ContactPoint::default(),
        }
    }

    /// Advances by `dt` s; the load's pressure is 0.
    pub fn step(&mut self, dt: f64, alpha: f64, alpha_rate: f64, pose: &Pose) -> SkinLoad {
        let (sin, cos) = libm::sincos(alpha);
        let r = DVec3::new(self.x, self.side * ARM_LENGTH * cos, HINGE_Z - ARM_LENGTH * sin);
        let by_alpha = DVec3::new(0.0, -self.side * ARM_LENGTH * sin, -ARM_LENGTH * cos);
        let velocity = pose.point_velocity(r, by_alpha * alpha_rate);
        let touch = self.point.force(
            dt,
            &TIP,
            PointMotion {
                position: pose.point(r),
                velocity,
            },
            &Surface::Ground(0.0),
        );
        let force = pose.to_body(touch.force);
        SkinLoad {
            force_body: force,
            moment_body: r.cross(force),
            moment_alpha: force.dot(by_alpha),
            pressure: 0.0,
        }
    }
}

#[cfg(test)]
mod tests;
