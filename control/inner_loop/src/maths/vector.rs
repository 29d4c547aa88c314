//! Three-vectors and unit quaternions in `f32`.

use core::ops::{Add, AddAssign, Mul, Neg, Sub};

use crate::maths::scalar;

/// A vector; frame and unit are the owner's.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vec3 {
    /// Forward or north component.
    pub x: f32,
    /// Right or east component.
    pub y: f32,
    /// Down component.
    pub z: f32,
}

impl Vec3 {
    /// Zero.
    pub const ZERO: Self = Self::new(0.0, 0.0, 0.0);

    /// From its components.
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self { x, y, z }
    }

    /// The components.
    pub const fn to_array(self) -> [f32; 3] {
        [self.x, self.y, self.z]
    }

    /// Scalar product.
    pub fn dot(self, o: Self) -> f32 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    /// Vector product, right-handed.
    pub fn cross(self, o: Self) -> Self {
        Self::new(
            self.y * o.z - self.z * o.y,
            self.z * o.x - self.x * o.z,
            self.x * o.y - self.y * o.x,
        )
    }

    /// Squared length.
    pub fn norm_squared(self) -> f32 {
        self.dot(self)
    }

    /// Length.
    pub fn norm(self) -> f32 {
        scalar::sqrt(self.norm_squared())
    }

    /// Product by component.
    pub fn scale_by(self, o: Self) -> Self {
        Self::new(self.x * o.x, self.y * o.y, self.z * o.z)
    }

    /// Applies `f` to each component.
    pub fn map(self, f: impl Fn(f32) -> f32) -> Self {
        Self::new(f(self.x), f(self.y), f(self.z))
    }

    /// True if the sum of the components, and so each, is finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        (self.x + self.y + self.z).is_finite()
    }
}

impl From<[f32; 3]> for Vec3 {
    fn from([x, y, z]: [f32; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self::new(self.x + o.x, self.y + o.y, self.z + o.z)
    }
}

impl AddAssign for Vec3 {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self::new(self.x - o.x, self.y - o.y, self.z - o.z)
    }
}

impl Mul<f32> for Vec3 {
    type Output = Self;
    fn mul(self, k: f32) -> Self {
        Self::new(self.x * k, self.y * k, self.z * k)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

/// Rotation from body to world, a unit quaternion, w first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quat {
    /// Scalar part.
    pub w: f32,
    /// Vector part, x.
    pub x: f32,
    /// Vector part, y.
    pub y: f32,
    /// Vector part, z.
    pub z: f32,
}

impl Default for Quat {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Quat {
    /// No rotation.
    pub const IDENTITY: Self = Self {
        w: 1.0,
        x: 0.0,
        y: 0.0,
        z: 0.0,
    };

    /// From roll, pitch and yaw (rad), in the order yaw, pitch, roll.
    pub fn from_euler(roll: f32, pitch: f32, yaw: f32) -> Self {
        let (sr, cr) = (scalar::sin(0.5 * roll), scalar::cos(0.5 * roll));
        let (sp, cp) = (scalar::sin(0.5 * pitch), scalar::cos(0.5 * pitch));
        let (sy, cy) = (scalar::sin(0.5 * yaw), scalar::cos(0.5 * yaw));
        Self {
            w: cr * cp * cy + sr * sp * sy,
            x: sr * cp * cy - cr * sp * sy,
            y: cr * sp * cy + sr * cp * sy,
            z: cr * cp * sy - sr * sp * cy,
        }
        .normalised()
    }

    /// Roll, pitch and yaw (rad).
    pub fn to_euler(self) -> (f32, f32, f32) {
        let Self { w, x, y, z } = self;
        let roll = scalar::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
        let pitch = scalar::asin(2.0 * (w * y - z * x));
        let yaw = scalar::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
        (roll, pitch, yaw)
    }

    /// The inverse rotation.
    pub fn conjugate(self) -> Self {
        Self {
            w: self.w,
            x: -self.x,
            y: -self.y,
            z: -self.z,
        }
    }

    /// Normalised to length one; identity if the length vanishes or is not finite.
    pub fn normalised(self) -> Self {
        let n2 = self.w * self.w + self.x * self.x + self.y * self.y + self.z * self.z;
        let k = scalar::inv_sqrt(n2);
        if k > 0.0 {
            Self {
                w: self.w * k,
                x: self.x * k,
                y: self.y * k,
                z: self.z * k,
            }
        } else {
            Self::IDENTITY
        }
    }

    /// A body vector in world axes.
    pub fn rotate(self, v: Vec3) -> Vec3 {
        let u = Vec3::new(self.x, self.y, self.z);
        let t = u.cross(v) * 2.0;
        v + t * self.w + u.cross(t)
    }

    /// A world vector in body axes.
    pub fn rotate_inverse(self, v: Vec3) -> Vec3 {
        self.conjugate().rotate(v)
    }

    /// World down in body axes: the third row of the rotation matrix.
    pub fn down_in_body(self) -> Vec3 {
        let Self { w, x, y, z } = self;
        Vec3::new(
            2.0 * (x * z - w * y),
            2.0 * (y * z + w * x),
            1.0 - 2.0 * (x * x + y * y),
        )
    }

    /// True if the sum of the components, and so each, is finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        (self.w + self.x + self.y + self.z).is_finite()
    }
}

impl Mul for Quat {
    type Output = Self;
    /// Hamilton product: first `o`, then `self`.
    fn mul(self, o: Self) -> Self {
        Self {
            w: self.w * o.w - self.x * o.x - self.y * o.y - self.z * o.z,
            x: self.w * o.x + self.x * o.w + self.y * o.z - self.z * o.y,
            y: self.w * o.y - self.x * o.z + self.y * o.w + self.z * o.x,
            z: self.w * o.z + self.x * o.y - self.y * o.x + self.z * o.w,
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_right_roll_puts_the_right_arm_down() {
        let q = Quat::from_euler(0.3, 0.0, 0.0);
        assert!(q.rotate(Vec3::new(0.0, 1.0, 0.0)).z > 0.29);
        let q = Quat::from_euler(0.0, 0.3, 0.0);
        assert!(q.rotate(Vec3::new(1.0, 0.0, 0.0)).z < -0.29);
        let q = Quat::from_euler(0.0, 0.0, 0.3);
        assert!(q.rotate(Vec3::new(1.0, 0.0, 0.0)).y > 0.29);
    }

    #[test]
    fn one_component_that_is_no_number_spoils_vector_and_quaternion() {
        let vector = |[x, y, z, _]: [f32; 4]| Vec3::new(x, y, z).is_finite();
        let quaternion = |[x, y, z, w]: [f32; 4]| Quat { w, x, y, z }.is_finite();
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for place in 0..4 {
                let mut parts = [0.5, -0.5, 0.5, -0.5];
                parts[place] = bad;
                assert_eq!(vector(parts), place == 3, "{parts:?}");
                assert!(!quaternion(parts), "{parts:?}");
            }
            assert!(!vector([bad, -bad, 0.0, 0.0]) && !quaternion([0.0, 0.0, bad, -bad]));
        }
        // Two that overflow together: implausible for this vehicle.
        for (a, b) in [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)] {
            let mut parts = [0.0; 4];
            (parts[a], parts[b]) = (3e38, 3e38);
            assert!(!quaternion(parts) && vector(parts) == (b == 3), "{parts:?}");
        }
        // Large, but a sum of three or four is finite.
        for parts in [[0.0; 4], [5e37; 4], [5e37, -5e37, 5e37, -5e37], [-1e-38; 4]] {
            assert!(vector(parts) && quaternion(parts), "{parts:?}");
        }
    }

    proptest! {
        #[test]
        fn euler_angles_come_back(r in -3.0f32..3.0, p in -1.3f32..1.3, y in -3.0f32..3.0) {
            let (r2, p2, y2) = Quat::from_euler(r, p, y).to_euler();
            // micromath's errors, magnified by the steep pitch.
            prop_assert!((r - r2).abs() < 0.03 && (p - p2).abs() < 0.03 && (y - y2).abs() < 0.03);
        }

        #[test]
        fn rotation_keeps_length_and_comes_back(
            r in -3.0f32..3.0, p in -1.5f32..1.5, y in -3.0f32..3.0,
            vx in -10.0f32..10.0, vy in -10.0f32..10.0, vz in -10.0f32..10.0,
        ) {
            let (q, v) = (Quat::from_euler(r, p, y), Vec3::new(vx, vy, vz));
            let w = q.rotate(v);
            prop_assert!((w.norm() - v.norm()).abs() < 1e-4 * (1.0 + v.norm()));
            prop_assert!((q.rotate_inverse(w) - v).norm() < 1e-4 * (1.0 + v.norm()));
            prop_assert!((q.down_in_body() - q.rotate_inverse(Vec3::new(0.0, 0.0, 1.0))).norm() < 1e-5);
        }
    }
}
