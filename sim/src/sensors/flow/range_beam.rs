//! The beam of the range sensor as far as geometry goes.

use glam::{DQuat, DVec3};

use crate::plant::contact::Pipe;

/// Half the beam, rad.
pub const HALF_BEAM: f64 = 3.0 / 180.0 * std::f64::consts::PI;

/// Range along the beam, m: the median of its rays.
pub fn distance(pipe: &Pipe, (from, attitude): (DVec3, DQuat)) -> Option<f64> {
    let side = libm::tan(HALF_BEAM);
    let mut found = [(0.0, 0.0), (side, 0.0), (-side, 0.0), (0.0, side), (0.0, -side)].map(|(u, w)| {
        pipe.or_ground_along(from, attitude * DVec3::new(u, w, 1.0))
            .unwrap_or(f64::INFINITY)
    });
    found.sort_by(f64::total_cmp);
    Some(found[2]).filter(|d| d.is_finite())
}
