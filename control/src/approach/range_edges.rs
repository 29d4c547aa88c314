//! Range edges: the beam steps onto a nearer surface, or falls off it.

use crate::maths::vector::Vec3;
use crate::navigation::surface_step::BEAM;

/// Least step, m: half the height of the smallest pipe, and three times the drop of a pipe's flank between two ranges.
const STEP: f32 = 0.12;
/// Share by which the surface depth follows each range of the same surface.
const FOLLOW: f32 = 0.5;
/// Way within which a further step to the same side belongs to the one before, beside the beam's width, m: two ranges'. A beam
/// that mixes pipe and ground reads something between them while it passes.
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
    /// Height of the last step, m, where it began, forward and right, m, and whether it led onto something.
    height: f32,
    edge: [f32; 2],
    onto: bool,
}

impl Edges {
    /// Takes the next hit of the beam, `range` m below the vehicle. A step that continues while the beam passes is
    /// returned again, with true.
    pub fn step(&mut self, surface_point: Vec3, range: f32) -> Option<(Edge, bool)> {
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
        let (onto, begin) = if off < 0.0 {
            (true, other)
        } else {
            (false, self.last)
        };
        let [x, y] = self.edge;
        let way = Vec3::new(surface_point.x - x, surface_point.y - y, 0.0);
        let passing = BEAM * (range - off.max(0.0)) + PASSING;
        let continues = self.height > 0.0 && onto == self.onto && way.norm_squared() < passing * passing;
        if !continues {
            (self.edge, self.onto, self.height) = ([begin.x, begin.y], onto, 0.0);
        }
        self.height += off.abs();
        (self.surface_depth, self.last, self.other) = (Some(surface_point.z), surface_point, None);
        let [x, y] = self.edge;
        let at = Vec3::new(x, y, begin.z);
        let edge = if onto {
            self.top = surface_point.z;
            Edge::Onto(at)
        } else {
            Edge::Off(at)
        };
        Some((edge, continues))
    }

    /// Takes a range with no target in reach, of a vehicle at `place`.
    pub fn step_beyond(&mut self, place: Vec3) -> Option<(Edge, bool)> {
        self.step(Vec3::new(place.x, place.y, BEYOND), BEYOND - place.z)
    }

    /// Depth of the present surface, m.
    pub fn surface_depth(&self) -> f32 {
        self.surface_depth.unwrap_or(BEYOND)
    }

    /// Depth of the ground, m: of the present surface, or below it by the step onto it. `None` before the first range, and
    /// where the ground is out of reach.
    pub fn ground_depth(&self) -> Option<f32> {
        let below = if self.onto { self.height } else { 0.0 };
        self.surface_depth
            .map(|depth| depth + below)
            .filter(|depth| *depth < 0.5 * BEYOND)
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
                Some((Edge::Onto(at), _)) => found[0] = Some(at.y),
                Some((Edge::Off(at), _)) => found[1] = Some(at.y),
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
