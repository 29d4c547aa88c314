//! Edges of the pipe: the range's beam comes onto the pipe, or off it.
//!
//! A beam has a width, and where it leans it falls beside the vehicle by as much as it is long: an edge is where the beam passes
//! the pipe's own level, half-way between the last hit on the one side and the first on the other.

use crate::maths::vector::Vec3;
use crate::navigation::estimate::SurfaceLevels;
use crate::navigation::range_hit::RangeHit;

/// Departure from the ground of what may be a pipe, m: half the height of the smallest.
const STEP: f32 = 0.12;

/// An edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Edge {
    /// Forward, right, down, m.
    pub at: Vec3,
    /// Way of the beam between the two ranges, m.
    pub way: Vec3,
    /// The beam has come onto the pipe.
    pub onto: bool,
}

/// Least cosine of a beam's tilt with which a level is reached.
const STEEPEST: f32 = 0.3;

/// Line of a beam: its point at the level 0, forward and right, m, and its way for each metre down.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Beam {
    zero: [f32; 2],
    slope: [f32; 2],
}

impl Beam {
    fn of(hit: &RangeHit) -> Self {
        let per = 1.0 / hit.beam.z.max(STEEPEST);
        let (lens, slope) = (hit.lens, [hit.beam.x * per, hit.beam.y * per]);
        let [x, y] = slope;
        Self {
            zero: [lens.x - x * lens.z, lens.y - y * lens.z],
            slope,
        }
    }

    /// Point in which it passes `level`, m down.
    fn at_level(&self, level: f32) -> Vec3 {
        let ([x, y], [ahead, right]) = (self.zero, self.slope);
        Vec3::new(x + ahead * level, y + right * level, level)
    }
}

/// Detector over consecutive ranges.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PipeEdges {
    /// The beam is on the pipe.
    on: bool,
    /// The level of the raised surface was known at the last range.
    known: bool,
    /// Newest hit on the present side.
    last: Option<Beam>,
    change: Change,
}

/// Change to the other side.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Change {
    #[default]
    None,
    /// The first hit there, to be confirmed by the next range.
    Begun(Beam),
    /// Hits on both sides of an edge of something whose level is not known yet.
    Passed([Beam; 2]),
}

impl PipeEdges {
    /// The beam is on the pipe.
    pub fn on(&self) -> bool {
        self.on
    }

    /// Takes the next range over a pipe of this `radius`, m.
    pub fn take(&mut self, hit: &RangeHit, levels: &SurfaceLevels, radius: f32) -> Option<Edge> {
        let known = core::mem::replace(&mut self.known, levels.raised.is_some());
        if known && !self.known {
            // The raised surface has proved to be the ground, without an edge.
            *self = Self::default();
        }
        let on = hit.surface_point.is_some_and(|point| match levels.raised {
            Some(level) => point.z - level < radius,
            None => levels.ground - point.z > STEP,
        });
        let beam = Beam::of(hit);
        let Some(last) = self.last else {
            (self.on, self.last) = (on, Some(beam));
            return None;
        };
        self.change = match (self.change, on == self.on) {
            (Change::Begun(_), true) => Change::None,
            (change, true) => change,
            (Change::Begun(first), false) => Change::Passed([last, first]),
            (_, false) => Change::Begun(beam),
        };
        if let Change::Begun(_) = self.change {
            return None;
        }
        (self.on, self.last) = (on, Some(beam));
        let (Change::Passed(beams), Some(level)) = (self.change, levels.raised) else {
            return None;
        };
        self.change = Change::None;
        let [last, first] = beams.map(|beam| beam.at_level(level));
        Some(Edge {
            at: (last + first) * 0.5,
            way: first - last,
            onto: self.on,
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::*;
    use std::vec::Vec;

    const PIPE: SurfaceLevels = SurfaceLevels {
        ground: 1.9,
        raised: Some(0.4),
    };

    /// Hit of a beam that leans by `slope` to the right from a lens at `y`, over a pipe between 0.3 and 0.6 m with its crown at
    /// 0.4 m, with what a beam of 6° mixes.
    fn hit(y: f32, slope: f32) -> RangeHit {
        let at = y + 0.4 * slope;
        let share = (0.5 + (0.15 - (at - 0.45).abs()) / 0.042).clamp(0.0, 1.0);
        let (pipe, ground) = (share / 0.16, (1.0 - share) / 3.61);
        let depth = (pipe * 0.4 + ground * 1.9) / (pipe + ground);
        RangeHit {
            surface_point: Some(Vec3::new(0.0, y + depth * slope, depth)),
            lens: Vec3::new(0.0, y, 0.0),
            beam: Vec3::new(0.0, slope, 1.0),
            ..RangeHit::default()
        }
    }

    /// Edges of a way across, with the level known from the hit of this number on.
    fn across(slope: f32, known: usize) -> Vec<Edge> {
        let mut edges = PipeEdges::default();
        let levels = |i| SurfaceLevels {
            raised: PIPE.raised.filter(|_| i >= known),
            ..PIPE
        };
        (0..200)
            .filter_map(|i| edges.take(&hit(0.005 * i as f32, slope), &levels(i), 0.15))
            .collect()
    }

    #[test]
    fn an_edge_is_where_the_beam_passes_the_pipes_level() {
        for slope in [-0.1, 0.0, 0.1] {
            for known in [0, 70] {
                let [onto, off] = across(slope, known)[..] else {
                    panic!("{slope} {known}");
                };
                assert!(onto.onto && !off.onto);
                let middle = 0.5 * (onto.at.y + off.at.y);
                assert!((middle - 0.45).abs() < 0.01, "{slope} {known}: {middle}");
                let width = off.at.y - onto.at.y;
                assert!((0.3..0.345).contains(&width), "{slope} {known}: {width}");
            }
        }
    }

    /// A vehicle that begins over the pipe has passed no edge onto it.
    #[test]
    fn no_edge_is_made_up() {
        let mut edges = PipeEdges::default();
        let found: Vec<_> = (80..200)
            .filter_map(|i| edges.take(&hit(0.005 * i as f32, 0.0), &PIPE, 0.15))
            .collect();
        assert!(found.len() == 1 && !found[0].onto, "{found:?}");
        // Out of reach is off the pipe; one range that misses it is no edge.
        let mut edges = PipeEdges::default();
        let gone = RangeHit {
            surface_point: None,
            ..hit(0.5, 0.0)
        };
        let on = hit(0.45, 0.0);
        for hit in [on, on, gone, on, on] {
            assert_eq!(edges.take(&hit, &PIPE, 0.15), None);
        }
        assert_eq!(edges.take(&gone, &PIPE, 0.15), None);
        assert!(edges.take(&gone, &PIPE, 0.15).is_some_and(|edge| !edge.onto));
        // What is as wide as the ground becomes it under the beam.
        let mut edges = PipeEdges::default();
        let ground = SurfaceLevels {
            ground: 0.4,
            raised: None,
        };
        for levels in [PIPE, PIPE, ground, ground, ground] {
            assert_eq!(edges.take(&on, &levels, 0.15), None, "{levels:?}");
        }
    }
}
