//! The pipe: a cylinder that runs north, with what real ones have besides.

mod flange;
mod ray;
mod vibration;

use glam::{DVec2, DVec3};

pub use self::flange::Flange;
pub use self::ray::Hit;
pub use self::vibration::Vibration;

/// A north-south pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pipe {
    /// Middle of the pipe, north, m.
    pub north: f64,
    /// Half length, m; may be infinite.
    pub half_length: f64,
    /// Axis, east, m.
    pub east: f64,
    /// Axis at the middle, down, m (negative above the ground).
    pub down: f64,
    /// Outer radius, m.
    pub radius: f64,
    /// Coefficient of sliding friction.
    pub friction: f64,
    /// Errors of a real one.
    pub shape: PipeShape,
}

/// Departures from a straight, level, bare, rigid and still cylinder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PipeShape {
    /// Rise towards the north, rad.
    pub slope: f64,
    /// Height of both ends over the middle, m: the parabola of an evenly loaded span.
    pub sag: f64,
    /// Flanges.
    pub flange: Flange,
    /// Depth by which cladding over insulation gives under a contact point, m/N: a spring in series with the pad's.
    pub softness: f64,
    /// Coefficient of static friction over that of sliding.
    pub static_share: f64,
    /// Displacement of the vibrating pipe down, m, and its velocity, m/s.
    pub heave: f64,
    /// Velocity of the vibrating pipe down, m/s.
    pub heave_speed: f64,
}

impl PipeShape {
    /// None.
    pub const STRAIGHT: Self = Self {
        slope: 0.0,
        sag: 0.0,
        flange: Flange::NONE,
        softness: 0.0,
        static_share: 1.0,
        heave: 0.0,
        heave_speed: 0.0,
    };
}

impl Default for PipeShape {
    fn default() -> Self {
        Self::STRAIGHT
    }
}

impl Pipe {
    /// A point (m, NED) in axes of the pipe from its middle: along it, right, and down from its sagging axis, m.
    fn local(&self, point: DVec3) -> DVec3 {
        let middle = DVec3::new(self.north, self.east, self.down + self.shape.heave);
        let mut local = self.turned(point - middle);
        let share = local.x / self.half_length;
        local.z += self.shape.sag * (share * share);
        local
    }

    /// World axes to those of the sloping pipe: x along it, y east.
    fn turned(&self, v: DVec3) -> DVec3 {
        if self.shape.slope == 0.0 {
            return v;
        }
        let (sin, cos) = libm::sincos(self.shape.slope);
        DVec3::new(v.x * cos - v.z * sin, v.y, v.x * sin + v.z * cos)
    }

    /// The reverse of [`Pipe::turned`].
    fn turned_back(&self, v: DVec3) -> DVec3 {
        if self.shape.slope == 0.0 {
            return v;
        }
        let (sin, cos) = libm::sincos(self.shape.slope);
        DVec3::new(v.x * cos + v.z * sin, v.y, v.z * cos - v.x * sin)
    }

    /// A point (m, NED) across the pipe from its axis: right and down, m, whatever its length.
    #[must_use]
    pub fn across(&self, point: DVec3) -> DVec2 {
        let local = self.local(point);
        DVec2::new(local.y, local.z)
    }

    /// Distance of `point` (m, NED) from its surface, m: negative inside, infinite beyond its ends.
    #[must_use]
    pub fn gap(&self, point: DVec3) -> f64 {
        let local = self.local(point);
        if local.x.abs() > self.half_length {
            return f64::INFINITY;
        }
        let flange = self.shape.flange;
        let rise = if flange.stands_at(local.x) {
            flange.height
        } else {
            0.0
        };
        libm::hypot(local.y, local.z) - self.radius - rise
    }

    /// Radius of its thickest part, m.
    #[must_use]
    pub fn largest_radius(&self) -> f64 {
        self.radius + self.shape.flange.rise()
    }

    /// Depth (m) and outward normal (NED) at `point` (m, NED), if inside.
    pub(super) fn probe(&self, point: DVec3) -> Option<(f64, DVec3)> {
        let local = self.local(point);
        if local.x.abs() > self.half_length {
            return None;
        }
        let across = DVec2::new(local.y, local.z);
        let distance = across.length();
        let out = if distance > 1e-6 {
            across / distance
        } else {
            DVec2::new(0.0, -1.0)
        };
        let bare = (self.radius - distance, DVec3::new(0.0, out.x, out.y));
        let ring = self.shape.flange.probe(local.x, distance - self.radius, out);
        let (depth, n) = ring.filter(|(depth, _)| *depth > bare.0).unwrap_or(bare);
        (depth > 0.0).then(|| (depth, self.turned_back(self.sagged(local.x, n))))
    }

    /// Normal `n` at `x` along the pipe, leant with its sagging axis: the gradient of the distance from that axis.
    fn sagged(&self, x: f64, n: DVec3) -> DVec3 {
        if self.shape.sag == 0.0 {
            return n;
        }
        let along = 2.0 * self.shape.sag * x / (self.half_length * self.half_length);
        DVec3::new(n.x + n.z * along, n.y, n.z).normalize()
    }

    /// Outward normal of the bare pipe nearest to `point` (m, NED), NED.
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        let local = self.local(point);
        let n = DVec3::new(0.0, local.y, local.z).normalize_or(DVec3::NEG_Z);
        self.turned_back(self.sagged(local.x, n))
    }
}

#[cfg(test)]
mod tests;
