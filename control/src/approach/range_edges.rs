//! Range edges: the beam steps onto a nearer surface, or falls off it.

use crate::maths::vector::Vec3;

/// Least step, m: half the height of the smallest pipe, and three times the drop of a pipe's flank between two ranges.
const STEP: f32 = 0.12;
/// Share by which the surface depth follows each range of the same surface.
const FOLLOW: f32 = 0.5;
/// Way within which a further step to the same side belongs to the one before: a beam of 6° that mixes pipe and ground
/// reads something between them over its width, in parts of the range to the nearer, and two ranges' way, m.
const BEAM: f32 = 0.105;
const PASSING: f32 = 0.02;
/// Depth used for a range with no target in reach, m.
const BEYOND: f32 = 50.0;

/// A step, with the place of its edge: forward, right, down, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// Onto a nearer surface.
    Onto(Vec3),
    /// Off it.
    Off(Vec3),
}

impl Edge {
    /// A beam that is `near` m long down to the nearer surface still passes this edge where it has stepped by `step` to `hit`.
    fn is_passed_at(&self, step: &Self, hit: Vec3, near: f32) -> bool {
        let at = match (self, step) {
            (Self::Onto(at), Self::Onto(_)) | (Self::Off(at), Self::Off(_)) => *at,
            _ => return false,
        };
        let way = Vec3::new(hit.x - at.x, hit.y - at.y, 0.0);
        let passing = BEAM * near + PASSING;
        way.norm_squared() < passing * passing
    }
}

/// Edge detector over consecutive ranges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Edges {
    /// Depth of the present surface, m; `None` before the first range.
    surface_depth: Option<f32>,
    /// Highest point of the surface entered last, m.
    top: f32,
    last: Vec3,
    /// First hit on another surface, to be confirmed by the next range.
    other: Option<Vec3>,
    /// The last step, the depth before it and its height, m.
    step: Option<Edge>,
    before: f32,
    height: f32,
    continues: bool,
}

impl Edges {
    /// Takes the next hit of the beam, `range` m below the vehicle. A step that goes on while the beam passes is returned again.
    pub fn step(&mut self, surface_point: Vec3, range: f32) -> Option<Edge> {
        let Some(surface_depth) = self.surface_depth else {
            (self.surface_depth, self.top, self.last) =
                (Some(surface_point.z), surface_point.z, surface_point);
            return None;
        };
        let off = surface_point.z - surface_depth;
        if off.abs() < STEP {
            let surface_depth = surface_depth + FOLLOW * off;
            (self.surface_depth, self.last, self.other) = (Some(surface_depth), surface_point, None);
            self.top = self.top.min(surface_depth);
            return None;
        }
        let other = self.other.replace(surface_point)?;
        if (other.z - surface_depth) * off < 0.0 || (other.z - surface_point.z).abs() > STEP {
            return None;
        }
        // The edge is at the higher surface's hit: a tilted beam meets the ground a hand's breadth beside the edge.
        let step = if off < 0.0 {
            Edge::Onto(other)
        } else {
            Edge::Off(self.last)
        };
        let passing = self
            .step
            .filter(|before| before.is_passed_at(&step, surface_point, range - off.max(0.0)));
        self.continues = passing.is_some();
        if !self.continues {
            (self.step, self.before) = (Some(step), surface_depth);
        }
        self.height = (surface_point.z - self.before).abs();
        (self.surface_depth, self.last, self.other) = (Some(surface_point.z), surface_point, None);
        if off < 0.0 {
            self.top = surface_point.z;
        }
        self.step
    }

    /// The last step continued the one before it.
    pub fn continues(&self) -> bool {
        self.continues
    }

    /// Takes a range with no target in reach, of a vehicle at `place`.
    pub fn step_beyond(&mut self, place: Vec3) -> Option<Edge> {
        self.step(Vec3::new(place.x, place.y, BEYOND), BEYOND - place.z)
    }

    /// Depth of the present surface, m.
    pub fn surface_depth(&self) -> f32 {
        self.surface_depth.unwrap_or(BEYOND)
    }

    /// Height of the last step, m; `None` if one side of it was out of reach.
    pub fn height(&self) -> Option<f32> {
        Some(self.height).filter(|height| *height < 0.5 * BEYOND)
    }

    /// Highest point of the surface entered last, m down.
    pub fn top(&self) -> f32 {
        self.top
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The surface_point of a beam that leans by 0.1: beside the pipe it falls 15 cm farther off than on it.
    #[test]
    fn an_edge_is_where_the_beam_meets_the_pipe() {
        let mut edges = Edges::default();
        let mut found = [None; 2];
        for step in 0..100u8 {
            let y = 0.01 * f32::from(step);
            let on = (0.3..0.6).contains(&(y + 0.04));
            let (z, surface_point) = if on { (0.4, y + 0.04) } else { (1.9, y + 0.19) };
            match edges.step(Vec3::new(0.0, surface_point, z), z) {
                Some(Edge::Onto(at)) => found[0] = Some(at.y),
                Some(Edge::Off(at)) => found[1] = Some(at.y),
                None => (),
            }
        }
        let [onto, off] = found.map(|at| at.expect("an edge"));
        assert!(
            (onto - 0.3).abs() < 0.011 && (off - 0.6).abs() < 0.011,
            "{onto} {off}"
        );
    }
}
