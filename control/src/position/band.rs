//! Where something narrow lies below, a pipe, by the step of the range at its edge: what share of the flow's view it fills.

use crate::math;
use crate::vector::Vec3;

/// Width of what the vehicle perches on, m, and that of the flow's view at a distance of 1 m (42° across).
const NARROW: f32 = 0.3;
const VIEW: f32 = 0.77;
/// Share of its half width within which its shape says something of the height, and deviation of its place, m.
const ROUND: f32 = 0.85;
const PLACE: f32 = 0.04;
/// Rays that stand for the view, and the nearest distance of one, m.
const RAYS: u32 = 9;
const NEAREST: f32 = 0.05;
/// How far the range may contradict the place, m: another width, and drift since the edge.
const SLACK: f32 = 0.08;

/// A band along the vehicle, or across it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Point in its middle, and the direction across it, level, in the estimate's axes.
    middle: Vec3,
    across: Vec3,
    /// Its height along the down axis, m.
    pub top: f32,
}

impl Band {
    /// The band whose edge is at `foot`, `onto` or off which the beam has come with a vehicle at `velocity` and `heading`,
    /// rad: the way it mostly moves, forward or sideways, leads across.
    pub fn at_edge(foot: Vec3, onto: bool, velocity: Vec3, heading: f32, top: f32) -> Self {
        let (sin, cos) = (math::sin(heading), math::cos(heading));
        let (ahead, right) = (Vec3::new(cos, sin, 0.0), Vec3::new(-sin, cos, 0.0));
        let (forward, sideways) = (velocity.dot(ahead), velocity.dot(right));
        let (across, speed) = if sideways.abs() > forward.abs() {
            (right, sideways)
        } else {
            (ahead, forward)
        };
        let half = if (speed > 0.0) == onto { 0.5 } else { -0.5 } * NARROW;
        Self {
            middle: foot + across * half,
            across,
            top,
        }
    }

    /// One of which only that it is below is known: its middle is at `foot`.
    pub fn below(foot: Vec3, top: f32) -> Self {
        Self {
            middle: foot,
            across: Vec3::new(0.0, 1.0, 0.0),
            top,
        }
    }

    /// A beam that meets what is `raised`, or the ground, at `foot` does not belie it.
    pub fn agrees(&self, foot: Vec3, raised: bool) -> bool {
        let off = self.off(foot);
        if raised {
            off < 0.5 * NARROW + SLACK
        } else {
            off > 0.5 * NARROW - SLACK
        }
    }

    /// How far its back has fallen at `foot` from its top, m, and by how much that is in doubt with the place; `None` near
    /// its edge.
    pub fn drop(&self, foot: Vec3) -> Option<(f32, f32)> {
        const RADIUS: f32 = 0.5 * NARROW;
        let off = self.off(foot);
        let square = RADIUS * RADIUS - off * off;
        let per = math::inv_sqrt(square);
        (off < ROUND * RADIUS).then_some((RADIUS - square * per, PLACE * off * per))
    }

    /// `below` its top, m, there is its own flank.
    pub fn is_flank(&self, foot: Vec3, below: f32) -> bool {
        below < 0.5 * NARROW + PLACE && self.off(foot) < 0.5 * NARROW + PLACE
    }

    fn off(&self, foot: Vec3) -> f32 {
        (foot - self.middle).dot(self.across).abs()
    }

    /// Mean of 1/distance over the view from `place`, 1/m, whose middle falls at `foot`: rays across the round band, `far`
    /// m to the ground beside it.
    pub fn nearness(&self, place: Vec3, foot: Vec3, far: f32) -> f32 {
        const RADIUS: f32 = 0.5 * NARROW;
        let near = math::clamp(self.top - place.z, NEAREST, far);
        let y = (place - self.middle).dot(self.across);
        let slope = (foot - place).dot(self.across) / math::clamp(foot.z - place.z, NEAREST, 100.0);
        let deep = near + RADIUS;
        let mut sum = 0.0;
        for ray in 0..RAYS {
            let side = (ray as f32 + 0.5) / RAYS as f32 - 0.5;
            let t = slope + VIEW * side;
            // Where the ray (y + t z, z) meets the circle about (0, deep).
            let (a, b) = (1.0 + t * t, deep - y * t);
            let square = b * b - a * (y * y + deep * deep - RADIUS * RADIUS);
            let root = square * math::inv_sqrt(square);
            let z = if square >= 0.0 { (b - root) / a } else { far };
            sum += 1.0 / math::clamp(z, NEAREST, far);
        }
        sum / RAYS as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_is_as_near_as_what_fills_it() {
        let right = Vec3::new(0.0, 0.3, 0.0);
        let band = Band::at_edge(Vec3::new(2.0, 0.85, 0.0), true, right, 0.0, -1.5);
        // Its middle is at 1 m, the ground 1.9 m below the vehicle.
        let depth = |y: f32, z: f32, slope: f32| {
            let foot = Vec3::new(0.0, y - slope * z, 0.0);
            1.0 / band.nearness(Vec3::new(0.0, y, z), foot, -z)
        };
        // From 0.4 m its tangents, 15.8° to each side, are 74 % of the view; from 0.7 m 47 %.
        let over = depth(1.0, -1.9, 0.0);
        assert!((over - 1.0 / (0.74 / 0.43 + 0.26 / 1.9)).abs() < 0.06, "{over}");
        let higher = depth(1.0, -2.2, 0.0);
        assert!(
            (higher - 1.0 / (0.47 / 0.73 + 0.53 / 2.2)).abs() < 0.15,
            "{higher}"
        );
        // Far beside it there is the ground alone, and near it the flank of the band is in the view.
        assert!((depth(1.8, -1.9, 0.0) - 1.9).abs() < 1e-3);
        let beside = depth(1.28, -1.9, 0.0);
        assert!((1.0..1.6).contains(&beside), "{beside}");
        // A view that leans to it sees more of it.
        assert!(depth(1.28, -1.9, -0.2) < beside && depth(0.72, -1.9, 0.2) < beside);
    }

    #[test]
    fn either_edge_from_either_side_gives_the_same_band() {
        for (edge, onto, speed) in [
            (0.85, true, 0.3),
            (1.15, true, -0.3),
            (1.15, false, 0.3),
            (0.85, false, -0.3),
        ] {
            let band = Band::at_edge(
                Vec3::new(5.0, edge, 0.0),
                onto,
                Vec3::new(0.1, speed, 0.0),
                0.0,
                -1.5,
            );
            for y in [0.7, 0.9, 1.0, 1.2] {
                let foot = Vec3::new(0.0, y, 0.0);
                assert!(
                    (band.off(foot) - (y - 1.0).abs()).abs() < 1e-6,
                    "{edge} {onto} {speed}"
                );
            }
            assert!(
                band.agrees(Vec3::new(0.0, 1.1, 0.0), true) && !band.agrees(Vec3::new(0.0, 1.3, 0.0), true)
            );
            assert!(
                !band.agrees(Vec3::new(0.0, 1.0, 0.0), false) && band.agrees(Vec3::new(0.0, 0.6, 0.0), false)
            );
        }
    }
}
