//! Springs and dampers of the parts that touch.

use super::{SKIN_STIFFNESS, STATION_SIZE, restitution};

/// Springs and dampers of a contact point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pad {
    /// Stiffness along the normal, N/m.
    pub stiffness: f64,
    /// Damping along the normal, N·s/m; full from a depth of 1 mm.
    pub damping: f64,
    /// Stiffness of the bristle along the surface, N/m.
    pub bristle: f64,
    /// Damping of the bristle along the surface, N·s/m.
    pub bristle_damping: f64,
    /// Damping of a pad that rebounds, as [`rebound`](super::rebound) has it of a coefficient of restitution; 0: `damping`.
    pub rebound: f64,
}

impl Pad {
    /// The same that rebounds as [`rebound`](super::rebound) says.
    #[must_use]
    pub const fn rebounding(self, rebound: f64) -> Self {
        Self { rebound, ..self }
    }

    /// Damping (N·s/m) along the normal of a pad that rests `depth` m deep.
    #[must_use]
    pub fn resting_damping(&self, depth: f64) -> f64 {
        if self.rebound > 0.0 {
            return restitution::slope(self.rebound, self.stiffness, depth);
        }
        self.damping * (depth / FULL_DAMPING_DEPTH).min(1.0)
    }
}

/// Depth from which a contact damps in full, m: no step at the touch.
const FULL_DAMPING_DEPTH: f64 = 1e-3;

/// A quarter of the vehicle per belly pad: 15 Hz, damping ratio 0.5.
pub const BELLY: Pad = Pad {
    stiffness: 4.0e3,
    damping: 42.0,
    bristle: 4.0e3,
    bristle_damping: 42.0,
    rebound: 0.0,
};
/// A station of an arm's underside.
pub const SKIN: Pad = Pad {
    stiffness: SKIN_STIFFNESS * STATION_SIZE.0 * STATION_SIZE.1,
    damping: 8.0,
    bristle: 400.0,
    bristle_damping: 4.0,
    rebound: 0.0,
};
/// Tip of 77 g: 22 Hz, damping ratio 0.5, no friction.
pub const TIP: Pad = Pad {
    stiffness: 1.5e3,
    damping: 10.0,
    bristle: 0.0,
    bristle_damping: 0.0,
    rebound: 0.0,
};
