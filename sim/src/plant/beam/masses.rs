//! Point masses of an arm and their positions.

use super::super::body::{ArmPoint, BodySpec};
use super::super::contact::{ARM_LENGTH, ARM_X, HINGE_Z};
use super::twist::BLOCK_INERTIA;

/// Beam without motor, kg (paper, Table II).
const ARM: f64 = 0.140;
/// Motor, propeller and controller, kg (paper, Table II).
const TIP: f64 = 0.100;
/// Largest share of the vehicle's inertia about any axis, and of its mass, that arms have: a vehicle of less has lighter
/// arms.
const LARGEST_SHARE: f64 = 0.92;
const LARGEST_MASS_SHARE: f64 = 0.7;

/// Place of the point within the arm, share of its length.
pub const MIDDLE: f64 = 0.5;

/// Mass of an arm by Lobatto's points: root, middle and tip have 1/6, 2/3 and 1/6 of the beam, which leaves mass,
/// moment and inertia of a straight arm as they are. The root's share belongs to the body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Masses {
    /// Mass halfway along the arm, kg.
    pub middle: f64,
    /// Mass at the tip, motor included, kg.
    pub tip: f64,
    /// Inertia of motor and propeller about their own centre, any axis, kg·m².
    pub block: f64,
}

impl Masses {
    /// Masses of a vehicle's arms: those of Table II, or less if the vehicle's inertia or mass is too small for them.
    #[must_use]
    pub fn of(spec: &BodySpec) -> Self {
        let whole = Self::scaled(1.0);
        let [roll, pitch, yaw] = spec.inertia;
        let taken = whole.inertia();
        let room = [
            LARGEST_SHARE * roll / taken[0],
            LARGEST_SHARE * pitch / taken[1],
            LARGEST_SHARE * yaw / taken[2],
            LARGEST_MASS_SHARE * spec.mass / (4.0 * (whole.middle + whole.tip)),
        ];
        Self::scaled(room.into_iter().fold(1.0, f64::min))
    }

    /// The masses of Table II times `share`.
    #[must_use]
    pub fn scaled(share: f64) -> Self {
        Self {
            middle: share * ARM * 2.0 / 3.0,
            tip: share * (TIP + ARM / 6.0),
            block: share * BLOCK_INERTIA,
        }
    }

    /// The points of an arm.
    #[must_use]
    pub fn points(&self) -> [ArmPoint; 2] {
        [
            ArmPoint {
                mass: self.middle,
                out: MIDDLE * ARM_LENGTH,
                inertia: 0.0,
            },
            ArmPoint {
                mass: self.tip,
                out: ARM_LENGTH,
                inertia: self.block,
            },
        ]
    }

    /// Of four level arms about the vehicle's centre, kg·m².
    fn inertia(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for ArmPoint { mass, out, inertia } in self.points() {
            let (x2, y2, z2) = (ARM_X * ARM_X, out * out, HINGE_Z * HINGE_Z);
            for (sum, r2) in sum.iter_mut().zip([y2 + z2, x2 + z2, x2 + y2]) {
                *sum += 4.0 * (mass * r2 + inertia);
            }
        }
        sum
    }
}
