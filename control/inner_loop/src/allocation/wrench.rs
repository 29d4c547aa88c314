//! Wrench of the rotors, and values per arm.

/// One value per arm or rotor: 1 front-left, 2 rear-left, 3 front-right, 4 rear-right.
pub type PerArm<T> = [T; 4];

/// +1 for left arms, -1 for right ones: sign of a thrust's roll moment and of an inward lean's sideways force.
pub const SIDE: PerArm<f32> = [1.0, 1.0, -1.0, -1.0];
/// +1 for front arms, -1 for rear ones: sign of a thrust's pitch moment.
pub const FORE: PerArm<f32> = [1.0, -1.0, 1.0, -1.0];
/// Sign of the yaw moment of an inward lean, and of configuration B's rotor drag.
pub const YAW: PerArm<f32> = [1.0, -1.0, -1.0, 1.0];

/// Force along the thrust axis and moments about the body axes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// Force along -z (up), N, >= 0.
    pub thrust: f32,
    /// Moment about x, right side down positive, N·m.
    pub roll: f32,
    /// Moment about y, nose up positive, N·m.
    pub pitch: f32,
    /// Moment about z, clockwise from above positive, N·m.
    pub yaw: f32,
}

impl Wrench {
    /// True if the sum of the components, and so each, is finite.
    #[inline]
    pub fn is_finite(self) -> bool {
        (self.thrust + self.roll + self.pitch + self.yaw).is_finite()
    }
}

/// Sense of rotation of the rotors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Configuration {
    /// Rotors 1 and 4 clockwise from above: yaw is unstable with soft arms.
    A,
    /// Rotors 1 and 4 counter-clockwise from above, as in the paper.
    #[default]
    B,
}

impl Configuration {
    /// χ: sign of the rotor drag's yaw moment against an inward lean's; +1 for B, -1 for A.
    pub const fn chi(self) -> f32 {
        match self {
            Self::A => -1.0,
            Self::B => 1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_component_that_is_no_number_spoils_a_wrench() {
        let finite = |[thrust, roll, pitch, yaw]: [f32; 4]| {
            Wrench {
                thrust,
                roll,
                pitch,
                yaw,
            }
            .is_finite()
        };
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            for place in 0..4 {
                let mut parts = [17.7, 0.3, -0.2, 0.04];
                parts[place] = bad;
                assert!(!finite(parts), "{parts:?}");
            }
            assert!(!finite([17.7, bad, -bad, 0.0]));
        }
        for (a, b) in [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)] {
            let mut parts = [0.0; 4];
            (parts[a], parts[b]) = (3e38, 3e38);
            assert!(!finite(parts), "{parts:?}");
        }
        for parts in [[0.0; 4], [5e37; 4], [5e37, -5e37, 5e37, -5e37], [-1e-38; 4]] {
            assert!(finite(parts), "{parts:?}");
        }
    }
}
