//! Orientation of a sensor on the vehicle: a signed permutation of axes.

use sophie_control::maths::vector::Vec3;

/// A signed sensor axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// +x.
    PlusX,
    /// -x.
    MinusX,
    /// +y.
    PlusY,
    /// -y.
    MinusY,
    /// +z.
    PlusZ,
    /// -z.
    MinusZ,
}

impl Axis {
    /// Component of `v`, in sensor axes.
    pub const fn of(self, v: Vec3) -> f32 {
        match self {
            Self::PlusX => v.x,
            Self::MinusX => -v.x,
            Self::PlusY => v.y,
            Self::MinusY => -v.y,
            Self::PlusZ => v.z,
            Self::MinusZ => -v.z,
        }
    }

    const fn unit(self) -> [i8; 3] {
        match self {
            Self::PlusX => [1, 0, 0],
            Self::MinusX => [-1, 0, 0],
            Self::PlusY => [0, 1, 0],
            Self::MinusY => [0, -1, 0],
            Self::PlusZ => [0, 0, 1],
            Self::MinusZ => [0, 0, -1],
        }
    }
}

/// Direction of the sensor's x axis, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heading {
    /// Nose.
    #[default]
    Forward,
    /// Right.
    Right,
    /// Tail.
    Back,
    /// Left.
    Left,
}

/// The sensor axes along body forward, right and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting {
    forward: Axis,
    right: Axis,
    down: Axis,
}

impl Mounting {
    /// Sensor axes along body x (forward), y (right) and z (down); `None` unless right-handed.
    pub const fn new(forward: Axis, right: Axis, down: Axis) -> Option<Self> {
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (forward.unit(), right.unit(), down.unit());
        let determinant = (ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz;
        if determinant == 1 {
            Some(Self { forward, right, down })
        } else {
            None
        }
    }

    /// Marked side up (InvenSense and Bosch: x, y in the plane, z out of the marking), x axis to `heading`.
    pub const fn top_up(heading: Heading) -> Self {
        let (forward, right) = match heading {
            Heading::Forward => (Axis::PlusX, Axis::MinusY),
            Heading::Right => (Axis::PlusY, Axis::PlusX),
            Heading::Back => (Axis::MinusX, Axis::PlusY),
            Heading::Left => (Axis::MinusY, Axis::MinusX),
        };
        Self {
            forward,
            right,
            down: Axis::MinusZ,
        }
    }

    /// Marked side down, x axis to `heading`.
    pub const fn top_down(heading: Heading) -> Self {
        let (forward, right) = match heading {
            Heading::Forward => (Axis::PlusX, Axis::PlusY),
            Heading::Right => (Axis::MinusY, Axis::PlusX),
            Heading::Back => (Axis::MinusX, Axis::MinusY),
            Heading::Left => (Axis::PlusY, Axis::MinusX),
        };
        Self {
            forward,
            right,
            down: Axis::PlusZ,
        }
    }

    /// Rotates a vector from sensor axes to body axes.
    pub const fn to_body(self, sensor: Vec3) -> Vec3 {
        Vec3::new(
            self.forward.of(sensor),
            self.right.of(sensor),
            self.down.of(sensor),
        )
    }
}

impl Default for Mounting {
    fn default() -> Self {
        Self::top_up(Heading::Forward)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADINGS: [Heading; 4] = [Heading::Forward, Heading::Right, Heading::Back, Heading::Left];

    #[test]
    fn every_preset_is_a_rotation() {
        for heading in HEADINGS {
            for m in [Mounting::top_up(heading), Mounting::top_down(heading)] {
                assert_eq!(Mounting::new(m.forward, m.right, m.down), Some(m));
            }
        }
        assert_eq!(Mounting::new(Axis::PlusX, Axis::PlusY, Axis::MinusZ), None);
        assert_eq!(Mounting::new(Axis::PlusX, Axis::PlusX, Axis::PlusZ), None);
    }

    #[test]
    fn axes_point_where_the_heading_says() {
        // Sensor x axis in body axes, per heading.
        let expected = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        for (heading, [forward, right]) in HEADINGS.into_iter().zip(expected) {
            for mounting in [Mounting::top_up(heading), Mounting::top_down(heading)] {
                let x = mounting.to_body(Vec3::new(1.0, 0.0, 0.0));
                assert!(x == Vec3::new(forward, right, 0.0), "{heading:?}: {x:?}");
            }
        }
        // At rest with the marking up, specific force is +g along z: body -z.
        let rest = Mounting::default().to_body(Vec3::new(0.0, 0.0, 9.81));
        assert!(rest == Vec3::new(0.0, 0.0, -9.81));
    }
}
