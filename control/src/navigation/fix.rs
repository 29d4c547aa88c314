//! A pose that another sensor or computer has measured.

use crate::maths::scalar;
use crate::maths::vector::Vec3;

/// Farthest from the origin along an axis, m: beyond it a float has steps of a millimetre.
const POSITION_MAX: f32 = 10_000.0;
/// Largest heading, rad: one turn. Sine and cosine of a huge one are not finite.
const HEADING_MAX: f32 = 2.0 * scalar::PI;
/// Deviation of a fix of which nothing is known yet, m, and the bounds of a given or measured one, m.
pub const FIX_DEVIATION: f32 = 0.01;
pub(super) const DEVIATION_BOUNDS: (f32, f32) = (0.003, 0.5);

/// A pose that another sensor or computer has measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fix {
    /// When it was measured, µs.
    pub at_us: u64,
    /// In the sender's axes, down as the vehicle's, m.
    pub position: Vec3,
    /// Heading of the nose in the sender's axes, rad.
    pub heading: f32,
    /// Variance along each axis, m²; `None` if the sender gives none.
    pub variance: Option<Vec3>,
    /// Counts the jumps of the sender's estimate.
    pub resets: u8,
}

impl Fix {
    pub(crate) fn is_sane(&self) -> bool {
        let far = |x: f32| x.abs() > POSITION_MAX;
        let p = self.position;
        p.is_finite() && self.heading.abs() <= HEADING_MAX && !(far(p.x) || far(p.y) || far(p.z))
    }

    pub(crate) fn variance(&self) -> Vec3 {
        let (least, most) = DEVIATION_BOUNDS;
        let given = self.variance.filter(|v| v.is_finite());
        given.map_or(Vec3::new(1.0, 1.0, 1.0) * (FIX_DEVIATION * FIX_DEVIATION), |v| {
            v.map(|v| scalar::clamp(v, least * least, most * most))
        })
    }
}
