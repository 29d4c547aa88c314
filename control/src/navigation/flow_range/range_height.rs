//! Height by the range: the surface that the beam is on, the ranges that count, and their corrections.
//!
//! Two surfaces are known: the ground, which is the datum, and what is raised above it, a pipe, whose level is a state beside
//! height and speed. docs/design/navigation.md has the derivation.

use super::{COS_MIN, FlowRangeFusion, beam};
use crate::maths::elapsed::seconds;
use crate::maths::scalar;
use crate::maths::vector::Vec3;
use crate::navigation::axis_filter::{Axis, Change};
use crate::navigation::fix_age::HEIGHT_AGE;
use crate::navigation::history::{StateHistory, StateSnapshot};
use crate::navigation::pipe_footprint::PipeFootprint;
use crate::navigation::range_scale::Below;
use crate::navigation::settled_hits::TimedRange;
use crate::navigation::surface_step::{BEAM, SurfaceStep};
use crate::navigation::vertical_speed::VerticalState;

/// Deviation of a range, m, and error of its scale, 1: of modules of this class. The latter stays what it is: it widens what fits a
/// level, and says nothing of how fast a height follows.
const NOISE: f32 = 0.02;
const SCALE: f32 = 0.02;
/// Deviation of a level beside poses, m: their height drifts against the ground.
const POSED: f32 = 0.03;
/// Deviations from a level beyond which a range is of another surface, and the least such departure, m: a floor's own steps.
const GATE: f32 = 3.0;
const STEP: f32 = 0.12;
/// Deviations beyond which a range over the ground beside a pipe is a mixture of both, if it is too near, which a mixture is.
const NEAR_GATE: f32 = 1.5;
/// Ranges for which the error of a place on the pipe's back stays: half a second at 50 Hz.
const LASTING: f32 = 25.0;
/// Least height of a raised surface, m: the diameter of the smallest pipe. What departs by less is an error of the height.
const LOWEST: f32 = 0.2;
/// Way over a raised surface, in diameters of the pipe, beyond which it is the ground; deviation of a place by flow, m/√s, and how
/// many deviations are added.
const WIDE: f32 = 1.6;
const DRIFT: f32 = 0.04;
const SURE: f32 = 3.0;
/// Deviation of the crown's level by the flank alone, in radii.
const FLANK: f32 = 0.5;
/// Deviation of the place of an edge, m.
const PLACE: f32 = 0.04;
/// Age of the newest flow beyond which a way is not known, µs.
const FLOW_AGE: u64 = 300_000;
/// Gap between two ranges after which refused ones are counted from zero, µs.
const GAP: u64 = 500_000;
/// Time for which a range that has fitted no height for [`HEIGHT_AGE`] is left out, µs.
const LEFT_OUT: u64 = 5_000_000;
/// Steps a second that are tolerated, and the excess that is a fault: the beam of a vehicle that swings in gusts beside the edge
/// of a pipe crosses it 11 times in 4.3 s, a range that jumps each 0.3 s does so 12 times in 3.3 s.
const STEPS_RATE: f32 = 2.0;
const STEPS_MAX: f32 = 5.0;
/// Time for which a range that jumps is left out, µs.
const JUMPED: u64 = 1_000_000;
/// Distance, m, and time, µs, from the last hit of a narrow object after which its band is dropped: a pipe has ends.
const LEFT_BEHIND: (f32, u64) = (2.0, 20_000_000);
/// Share by which a level beside poses follows each range.
const FOLLOW: f32 = 0.2;
/// Time over which the motion of the beam across an edge is measured, µs.
const EDGE_TIME: u64 = 100_000;

/// What the range is fused with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Time of the estimate, µs.
    pub at_us: u64,
    /// Heading of its axes, rad.
    pub yaw_offset: f32,
    /// A fresh pose gives the height: the levels follow it.
    pub posed: bool,
    /// Vertical speed and bias with which a lost height restarts.
    pub anew: VerticalState,
}

/// A range, and where its beam ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hit {
    at_us: u64,
    /// Distance, m, and cosine of the beam's tilt.
    distance: f32,
    cos: f32,
    then: StateSnapshot,
    point: Vec3,
    yaw_offset: f32,
}

impl Hit {
    fn of(then: StateSnapshot, distance: f32, yaw_offset: f32) -> Option<Self> {
        let cos = then.q.down_in_body().z;
        (cos >= COS_MIN).then(|| Self {
            at_us: then.at_us,
            distance,
            cos,
            then,
            point: then.position + beam(then.q, distance, yaw_offset),
            yaw_offset,
        })
    }

    /// Variance of the distance, m².
    fn variance(&self) -> f32 {
        let scale = SCALE * self.distance;
        NOISE * NOISE + scale * scale
    }

    /// Point in which the beam passes `level`, m down.
    fn at_level(&self, level: f32) -> Vec3 {
        let reach = (level - self.then.position.z) / self.cos;
        self.then.position + beam(self.then.q, reach, self.yaw_offset)
    }
}

/// How a hit fits a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Fit {
    /// Level of the surface's highest point less that of the hit, m, and by how much its back is lower there, m.
    off: f32,
    drop: f32,
    /// Variance of the measurement, of its innovation, and of that without the doubt of the back, m².
    variance: f32,
    spread: f32,
    known: f32,
}

impl Fit {
    /// Level of the surface where the beam meets it less that of the hit, m.
    fn innovation(&self) -> f32 {
        self.off + self.drop
    }

    fn within(&self, deviations: f32) -> bool {
        let off = self.innovation();
        off * off <= deviations * deviations * self.spread
    }

    /// The hit is on the surface, whose back may fall off by `back`, m.
    fn is_on(&self, back: f32) -> bool {
        let near = STEP.max(GATE * scalar::sqrt(self.known));
        self.off.abs() <= near || (-back..0.0).contains(&self.off)
    }
}

impl FlowRangeFusion {
    /// Level of the surface that the beam is on, m.
    pub(super) fn present_level(&self) -> f32 {
        let raised = self.levels.raised.filter(|_| self.raised);
        raised.unwrap_or(self.levels.ground)
    }

    /// The beam is on something raised above the ground.
    #[cfg(test)]
    pub(crate) fn raised(&self) -> bool {
        self.raised
    }

    /// The surfaces are measured anew, from the next range on.
    pub fn forget_surfaces(&mut self) {
        self.anew = true;
        (self.raised, self.band, self.refused_us) = (false, None, None);
        (self.step, self.settled) = Default::default();
    }

    /// Takes a range, measured at a state of `history`, and corrects the vertical `axis` by those that have settled. Its measurement
    /// time, µs, if it fits the height; `None` if it does not, or if poses give the height.
    pub fn take_height(
        &mut self,
        axis: &mut Axis,
        history: &mut StateHistory,
        (at_us, distance): TimedRange,
        frame: &Frame,
    ) -> Option<u64> {
        self.levels.raised = axis.landmark();
        let counted = self.look(axis, history, (at_us, distance), frame);
        self.levels.raised = axis.landmark();
        counted
    }

    fn look(
        &mut self,
        axis: &mut Axis,
        history: &mut StateHistory,
        (at_us, distance): TimedRange,
        frame: &Frame,
    ) -> Option<u64> {
        let then = history.at(at_us)?.of(self.lens, frame.yaw_offset);
        let hit = Hit::of(then, distance, frame.yaw_offset)?;
        let gap = at_us.saturating_sub(core::mem::replace(&mut self.hit_us, at_us)) > GAP;
        if gap {
            self.refused_us = None;
            self.settled.restart(at_us);
        }
        if self.anew {
            return self.begin_surfaces(axis, &hit, frame);
        }
        if !self.scale.begun() {
            self.unproven = Some(hit.point);
        }
        let below = PipeFootprint::below(
            hit.point,
            hit.then.yaw() + frame.yaw_offset,
            self.radius,
            hit.point.z,
        );
        let wide = WIDE * 2.0 * self.radius;
        self.unproven = self.unproven.filter(|first| below.aside(*first).abs() <= wide);
        self.leave_behind(&hit);
        let fit = self.fit(axis, self.raised, &hit, frame);
        if fit.is_on(self.back()) {
            self.on_surface(axis, history, (&hit, &fit), frame)
        } else {
            self.refuse(at_us, frame);
            self.beside_surface(axis, history, &hit, frame);
            None
        }
    }

    /// By how much the present surface may fall off, m.
    fn back(&self) -> f32 {
        if self.raised { self.radius + PLACE } else { 0.0 }
    }

    /// The surfaces begin with the ground below.
    fn begin_surfaces(&mut self, axis: &mut Axis, hit: &Hit, frame: &Frame) -> Option<u64> {
        self.anew = false;
        axis.forget_landmark();
        self.levels.ground = hit.point.z;
        self.settled.restart(hit.at_us);
        self.surface_point = hit.point;
        // Verdicts on the flow by another depth are dropped.
        (self.agreements, self.unsure_us) = (Default::default(), hit.at_us);
        if frame.posed {
            return None;
        }
        if core::mem::take(&mut self.lost) {
            axis.start(&frame.anew);
        }
        Some(hit.at_us)
    }

    /// The band of a narrow object that is far behind is dropped.
    fn leave_behind(&mut self, hit: &Hit) {
        if self.raised {
            self.met = (hit.at_us, hit.point);
            return;
        }
        let (met_us, met) = self.met;
        let way = hit.point - met;
        let far = Vec3::new(way.x, way.y, 0.0).norm() > LEFT_BEHIND.0;
        let behind = far || hit.at_us.saturating_sub(met_us) > LEFT_BEHIND.1;
        self.band = self.band.filter(|_| !behind);
    }

    /// How `hit` fits the ground, or the `raised` surface.
    fn fit(&self, axis: &Axis, raised: bool, hit: &Hit, frame: &Frame) -> Fit {
        let noise = hit.variance();
        let pipe = axis.landmark().filter(|_| raised);
        let (drop, doubt) = match (pipe, self.band.filter(|_| self.raised)) {
            (None, _) => (0.0, 0.0),
            (Some(_), None) => (0.0, PLACE),
            (Some(_), Some(band)) => band.drop(hit.point, 0.5 * BEAM * hit.distance),
        };
        let known = match (frame.posed, pipe) {
            (true, _) => POSED * POSED,
            (false, Some(_)) => axis.distance_variance(),
            (false, None) => axis.position_variance(),
        };
        let doubt = doubt * doubt;
        Fit {
            off: pipe.unwrap_or(self.levels.ground) - hit.point.z,
            drop,
            variance: NOISE * NOISE + LASTING * doubt,
            spread: known + noise + doubt,
            known: known + noise,
        }
    }

    /// A hit on the present surface.
    fn on_surface(
        &mut self,
        axis: &mut Axis,
        history: &mut StateHistory,
        (hit, fit): (&Hit, &Fit),
        frame: &Frame,
    ) -> Option<u64> {
        (self.step, self.surface_point) = (SurfaceStep::default(), hit.point);
        let mixture = self.is_mixture(hit, fit);
        if mixture {
            self.settled.restart(hit.at_us);
            self.refuse(hit.at_us, frame);
            return None;
        }
        let raised = self.raised;
        self.band = self.band.map(|band| band.bounded(hit.at_level(band.top), raised));
        self.band = self.band.filter(|band| raised || !band.is_mistaken());
        if self.settled.arrived(hit.at_us) {
            let same = if raised || self.unproven.is_some() {
                Below::Narrow
            } else {
                Below::Plain
            };
            let below = self.arrived.take().unwrap_or(same);
            self.update_scale(hit.distance * hit.cos - fit.drop, hit.then.q, below);
        }
        self.refused_us = None;
        if self.raised && self.is_wide(hit) {
            // A surface as wide as this is the ground.
            self.levels.ground = self.present_level();
            axis.forget_landmark();
            (self.raised, self.band) = (false, None);
        }
        if frame.posed {
            let level = self.present_level() - FOLLOW * fit.innovation();
            if self.raised {
                axis.move_landmark(level);
            } else {
                self.levels.ground = level;
            }
            return None;
        }
        self.settled.push((hit.at_us, hit.distance));
        while let Some((at_us, distance)) = self.settled.pop(hit.at_us) {
            let then = history.at(at_us).map(|then| then.of(self.lens, frame.yaw_offset));
            if let Some(hit) = then.and_then(|then| Hit::of(then, distance, frame.yaw_offset)) {
                self.correct(axis, history, &hit, frame);
            }
        }
        Some(hit.at_us)
    }

    /// Fuses `hit` with the present surface.
    fn correct(&mut self, axis: &mut Axis, history: &mut StateHistory, hit: &Hit, frame: &Frame) {
        let fit = self.fit(axis, self.raised, hit, frame);
        let (off, variance) = (fit.innovation(), fit.variance);
        let lag = seconds(hit.at_us, frame.at_us);
        let change = if self.raised {
            axis.correct_beside(off, variance, lag)
        } else {
            axis.correct(off, variance, lag)
        };
        history.change(hit.at_us, &[Change::default(), Change::default(), change]);
    }

    /// Beside the edge of a pipe, or on its flank, the beam reads something between both surfaces.
    fn is_mixture(&self, hit: &Hit, fit: &Fit) -> bool {
        if self.raised {
            return !fit.within(GATE);
        }
        let Some(band) = self.band else {
            return false;
        };
        let (met_us, _) = self.met;
        let drift = SURE * DRIFT * scalar::sqrt(seconds(met_us, hit.at_us));
        let near = self.radius + BEAM * hit.distance + PLACE + drift;
        let gate = if fit.off > 0.0 { NEAR_GATE } else { GATE };
        band.aside(hit.at_level(band.top)).abs() < near && !fit.within(gate)
    }

    /// The beam has moved over the raised surface by more than a pipe is wide, whatever its place has drifted by. The nose is
    /// along a pipe that is perched on.
    fn is_wide(&self, hit: &Hit) -> bool {
        let (since_us, first) = self.entered;
        let drift = SURE * DRIFT * scalar::sqrt(seconds(since_us, hit.at_us));
        let here = PipeFootprint::below(
            hit.point,
            hit.then.yaw() + hit.yaw_offset,
            self.radius,
            hit.point.z,
        );
        let way = here.aside(first);
        let known = hit.at_us.saturating_sub(self.flow_us) < FLOW_AGE;
        known && way.abs() > WIDE * 2.0 * self.radius + drift
    }

    /// A range that does not count.
    fn refuse(&mut self, at_us: u64, frame: &Frame) {
        let since = *self.refused_us.get_or_insert(at_us);
        if seconds(since, at_us) <= HEIGHT_AGE {
            return;
        }
        self.forget_surfaces();
        if !frame.posed {
            self.lost = true;
            self.inconsistent_us = at_us.saturating_add(LEFT_OUT);
        }
    }

    /// A hit beside the present surface: the beam may have come onto another one.
    fn beside_surface(&mut self, axis: &mut Axis, history: &StateHistory, hit: &Hit, frame: &Frame) {
        if self.anew {
            return;
        }
        self.settled.restart(hit.at_us);
        let other = axis.landmark().is_some() || self.raised;
        let other = other.then(|| self.fit(axis, !self.raised, hit, frame));
        let back = if self.raised { 0.0 } else { self.radius + PLACE };
        let known = other.is_some_and(|fit| fit.is_on(back));
        let present = self.present_level();
        // A mixture with the ground is never deeper than the ground.
        let deeper = hit.point.z - self.levels.ground > STEP;
        let near = (hit.point.z.min(present) - hit.then.position.z).max(0.0);
        let over = self.step.take(
            (hit.at_us, hit.point),
            self.surface_point.z,
            near,
            known || deeper,
        );
        let continues = !known && !self.step.jumped();
        if continues && (deeper || self.band.is_none()) {
            // The same surface at another level: the height is wrong, or the range. Beside a pipe a mixture looks alike.
            self.update_scale(hit.distance * hit.cos, hit.then.q, Below::Narrow);
        }
        if continues {
            return;
        }
        if self.step.departs() {
            // The edge is at the higher surface's hit: a tilted beam meets the ground a hand's breadth beside it.
            self.stepped_at = if hit.point.z < present {
                hit.point
            } else {
                self.surface_point
            };
        }
        if over {
            self.enter(axis, history, hit, (known, frame));
        }
    }

    /// The beam has come onto the other surface, if that is `known`, or a new one.
    fn enter(&mut self, axis: &mut Axis, history: &StateHistory, hit: &Hit, (known, frame): (bool, &Frame)) {
        let (level, before) = (hit.point.z, self.present_level());
        let below_ground = level - self.levels.ground;
        if !known && below_ground.abs() <= LOWEST {
            // An error of the height, of whose size its variance knows nothing yet.
            return;
        }
        let onto = level < before;
        if known {
            self.raised = !self.raised;
        } else if below_ground > 0.0 {
            // The beam has fallen off what had been the ground.
            let ground = core::mem::replace(&mut self.levels.ground, level);
            axis.mark(ground, hit.variance());
            self.raised = false;
        } else {
            axis.mark(level, hit.variance());
            self.raised = true;
        }
        self.levels.raised = axis.landmark();
        self.see_edge(history, hit, onto, frame);
        if let (Some(band), false, true) = (self.band, known, onto) {
            // The flank alone was seen.
            let (drop, _) = band.drop(hit.point, 0.5 * BEAM * hit.distance);
            let flank = FLANK * self.radius;
            axis.mark(level - drop, hit.variance() + flank * flank);
        }
        self.step = SurfaceStep::default();
        self.settled.restart(hit.at_us);
        self.entered = (hit.at_us, hit.point);
        let fell = self.scale.begun() && !onto && level - before > 2.0 * self.radius;
        self.unproven = self.unproven.filter(|_| !fell);
        self.arrived = Some(if known { Below::Known } else { Below::New });
        self.count_step(hit.at_us);
    }

    /// Places the band by the edge that the beam has passed.
    fn see_edge(&mut self, history: &StateHistory, hit: &Hit, onto: bool, frame: &Frame) {
        let top = self.levels.raised.unwrap_or(self.levels.ground);
        let heading = hit.then.yaw() + frame.yaw_offset;
        let below = PipeFootprint::below(hit.point, heading, self.radius, top);
        let mut band = self.band.unwrap_or(below);
        band.top = top;
        let earlier = history.at(hit.at_us.saturating_sub(EDGE_TIME));
        let earlier = earlier.map(|then| then.of(self.lens, frame.yaw_offset));
        let before = earlier.and_then(|then| Hit::of(then, hit.distance, frame.yaw_offset));
        let displacement = hit.at_level(top) - before.unwrap_or(*hit).at_level(top);
        let edge = PipeFootprint::at_edge(band, self.stepped_at, onto, displacement, heading);
        (self.band, self.surface_point) = (Some(edge), hit.point);
    }

    /// Counts a change of the surface: a range that jumps changes it more often than ground does.
    fn count_step(&mut self, now: u64) {
        let faded = STEPS_RATE * seconds(self.stepped_us, now);
        (self.steps, self.stepped_us) = ((self.steps - faded).max(0.0) + 1.0, now);
        if self.steps > STEPS_MAX {
            self.distrusted_us = now.saturating_add(JUMPED);
            self.steps = 0.0;
        }
    }
}
