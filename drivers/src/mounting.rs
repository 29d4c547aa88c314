//! How a sensor sits on the vehicle: a signed permutation of its axes.

use sophie_control::vector::Vec3;

/// One axis of a sensor, with its sense.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Along the sensor's x axis.
    PlusX,
    /// Against the sensor's x axis.
    MinusX,
    /// Along the sensor's y axis.
    PlusY,
    /// Against the sensor's y axis.
    MinusY,
    /// Along the sensor's z axis.
    PlusZ,
    /// Against the sensor's z axis.
    MinusZ,
}

impl Axis {
    /// This component of a vector in the sensor's axes.
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

/// Where the sensor's x axis points, seen from above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Heading {
    /// To the nose.
    #[default]
    Forward,
    /// To the right.
    Right,
    /// To the tail.
    Back,
    /// To the left.
    Left,
}

/// How a sensor sits: which of its axes lies along body forward, right and down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mounting {
    forward: Axis,
    right: Axis,
    down: Axis,
}

impl Mounting {
    /// The mounting with these axes along body x (forward), y (right) and z (down); `None` unless they are a
    /// right-handed triple, which every real mounting is.
    pub const fn new(forward: Axis, right: Axis, down: Axis) -> Option<Self> {
        let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (forward.unit(), right.unit(), down.unit());
        let determinant = (ay * bz - az * by) * cx + (az * bx - ax * bz) * cy + (ax * by - ay * bx) * cz;
        if determinant == 1 {
            Some(Self { forward, right, down })
        } else {
            None
        }
    }

    /// The part's marked side up, as the InvenSense and Bosch parts draw it (x, y in the plane, z out of
    /// the marking), its x axis pointing to `heading`.
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

    /// The part's marked side down, its x axis pointing to `heading`.
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

    /// A vector in the sensor's axes, turned into body axes (forward, right, down).
    pub const fn to_body(self, sensor: Vec3) -> Vec3 {
        Vec3::new(
            self.forward.of(sensor),
            self.right.of(sensor),
            self.down.of(sensor),
        )
    }
}

impl Default for Mounting {
    /// Marked side up, x forward.
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
        // The sensor's x axis in body axes, for each heading.
        let expected = [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
        for (heading, [forward, right]) in HEADINGS.into_iter().zip(expected) {
            for mounting in [Mounting::top_up(heading), Mounting::top_down(heading)] {
                let x = mounting.to_body(Vec3::new(1.0, 0.0, 0.0));
                assert!(x == Vec3::new(forward, right, 0.0), "{heading:?}: {x:?}");
            }
        }
        // At rest an accelerometer with its marking up sees +g along z: specific force is up, body -z.
        let rest = Mounting::default().to_body(Vec3::new(0.0, 0.0, 9.81));
        assert!(rest == Vec3::new(0.0, 0.0, -9.81));
    }
}
