//! Flanges: rings that stand out of the pipe. Of a contact point inside one the nearer of its faces pushes it out, round or
//! side. Points meet it, not areas: half a station's width is added to its thickness, and an arm bridges what lies between
//! its stations.
//!
//! EN 1092-1, DN 300, PN 16: 460 mm across on a pipe of 324 mm, 28 mm thick; two of them, bolted, with their gasket.

use glam::{DVec2, DVec3};

/// Half the thickness of a bolted pair, m, and half the width of a station that rests on it, m.
const HALF_THICKNESS: f64 = 0.030;
const HALF_STATION: f64 = 0.015;

/// Flanges of a pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flange {
    /// Distance between two, m; 0 without flanges.
    pub spacing: f64,
    /// Place of one from the pipe's middle, north, m.
    pub at: f64,
    /// Height over the pipe, m.
    pub height: f64,
}

impl Flange {
    /// No flange.
    pub const NONE: Self = Self {
        spacing: 0.0,
        at: 0.0,
        height: 0.0,
    };

    /// Height over the pipe, m; 0 without flanges.
    #[must_use]
    pub fn rise(&self) -> f64 {
        if self.spacing > 0.0 { self.height } else { 0.0 }
    }

    /// Distance (m) of `x` m along the pipe from the middle of the nearest flange, north positive; `None` without flanges.
    fn beside(&self, x: f64) -> Option<f64> {
        (self.spacing > 0.0).then(|| {
            let from = x - self.at;
            from - (from / self.spacing).round() * self.spacing
        })
    }

    /// Whether a flange stands at `x` m along the pipe.
    #[must_use]
    pub fn stands_at(&self, x: f64) -> bool {
        self.beside(x)
            .is_some_and(|beside| beside.abs() <= HALF_THICKNESS)
    }

    /// Depth (m) and normal, in axes of the pipe, of a point `x` m along it, `height` m over its surface in the direction
    /// `out` across it.
    pub(super) fn probe(&self, x: f64, height: f64, out: DVec2) -> Option<(f64, DVec3)> {
        let beside = self.beside(x)?;
        let round = self.height - height;
        let side = HALF_THICKNESS + HALF_STATION - beside.abs();
        if round <= 0.0 || side <= 0.0 {
            return None;
        }
        Some(if round <= side {
            (round, DVec3::new(0.0, out.x, out.y))
        } else {
            (side, DVec3::new(beside.signum(), 0.0, 0.0))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const UP: DVec2 = DVec2::new(0.0, -1.0);

    #[test]
    fn the_nearer_face_of_a_flange_pushes_and_none_stands_between_two() {
        let flange = Flange {
            spacing: 1.0,
            at: 0.3,
            height: 0.07,
        };
        let (depth, n) = flange.probe(0.3, 0.069, UP).unwrap();
        assert!((depth - 1e-3).abs() < 1e-12 && n == DVec3::new(0.0, 0.0, -1.0));
        // 2 mm inside its northern side, low.
        let (depth, n) = flange.probe(-0.7 + 0.043, 0.01, UP).unwrap();
        assert!((depth - 2e-3).abs() < 1e-12 && n == DVec3::X, "{depth} {n}");
        assert!(flange.probe(0.0, 0.01, UP).is_none() && flange.probe(0.3, 0.071, UP).is_none());
        assert!(flange.stands_at(1.3) && !flange.stands_at(1.34));
        assert!(Flange::NONE.probe(0.0, 0.0, UP).is_none() && !Flange::NONE.stands_at(0.0));
    }
}
