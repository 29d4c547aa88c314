//! Planner of the autonomous approach, 100 Hz: finds the crown by range steps, searches the pipe's ends, and descends
//! over the crown. It commands velocities, as the sticks do in a hold; docs/hold.md describes it.
//!
//! Lengths are relative to the beginning of an attempt: forward and right along its heading, down.

#[cfg(test)]
mod tests;
mod to_target;

use crate::approach::limits::*;
use crate::approach::pipe_target::PipeTarget;
use crate::approach::range_edges::{Edge, Edges};
use crate::maths::frames::about_down;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{self, clamp, clamp_abs};
use crate::maths::vector::Vec3;
use crate::navigation::range_hit::RangeHit;
use crate::params::Params;
use crate::position_hold::VelocityCommand;

/// Reason for which an attempt ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ApproachAbort {
    /// No pipe across the whole sweep.
    NoPipe,
    /// The pipe is too short between its ends.
    TooShort,
    /// The range no longer meets the pipe.
    PipeLost,
    /// The vehicle does not settle over the crown, or two crossings differ.
    NotCentred,
    /// No contact at the expected crown.
    NotTouched,
    /// The range is stale.
    RangeStale,
    /// The range shows an unknown surface below the crown.
    RangeMisfit,
    /// The range shows higher steps than the first crossing.
    RangeLong,
    /// The reported place of the pipe is stale.
    TargetStale,
    /// The reported place is out of reach.
    TargetFar,
    /// The reported place jumps.
    TargetJumps,
}

/// Input of the planner, in the estimate's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// m.
    pub position: Vec3,
    /// m/s.
    pub velocity: Vec3,
    /// Heading of the nose, rad.
    pub heading: f32,
    /// The point that is held, m.
    pub held: Vec3,
    /// Age of the newest fix or flow, s.
    pub age: f32,
    /// Newest hit of the range.
    pub range_hit: RangeHit,
    /// Reported place of the pipe; with it the range is not used.
    pub target: Option<PipeTarget>,
}

/// Phase of the approach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Climb off the pipe; then another attempt, or the end.
    Climb,
    /// Sweep across, wider each time, until the pipe is crossed.
    Search,
    /// Fly over the crown, and down to the height of the crossings.
    Over,
    /// Search the ends along the pipe, forward and back.
    Fore,
    Aft,
    /// Cross the pipe to find the crown.
    Cross,
    /// Settle over the crown.
    Centre,
    /// Descend to the gate.
    Descend,
    /// Descend onto the pipe.
    Commit,
}

/// An unexpected range step: the abort reason for it, the surface depth before it, m down, and its duration, s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Other {
    doubt: ApproachAbort,
    from: f32,
    seconds: f32,
}

/// The planner and its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ApproachPlanner {
    diameter: f32,
    /// Lens of the range from the centre of mass, m: forward, right, down, with the nose along the pipe.
    lens: Vec3,
    origin: Vec3,
    heading: f32,
    reset_count: u8,
    phase: Phase,
    /// Time in the phase, s.
    since: f32,
    /// The vehicle only climbs, to leave the pipe.
    leaves: bool,
    /// This is another attempt after an earlier one.
    returns: bool,
    /// Height to climb to, m.
    up: f32,
    edges: Edges,
    seen: u8,
    /// Heights of the steps onto the pipe and off it at the first crossing, m: infinite until then, and if the surface
    /// beside it was out of reach.
    steps: [f32; 2],
    /// The last step off the pipe is the one of the first crossing.
    first_off: bool,
    /// Longest range so far, m.
    farthest: f32,
    other: Option<Other>,
    /// Middle of the sweeps, forward and right, m; side of the present leg, half the sweep's width, m, and legs flown.
    middle: Vec3,
    side: f32,
    reach: f32,
    legs: u8,
    /// Place at which the range came onto the pipe, right, m.
    entered: Option<f32>,
    /// Middle of the object that the search met last, by one of its edges, right, m.
    met: Option<f32>,
    /// The pipe's crown, right and down, m, and half the pipe's width, m.
    crown_y: f32,
    crown_z: f32,
    half: f32,
    /// The crown is that of a crossing from this height.
    crown_crossed: bool,
    /// Landing point along the pipe, m, and the ends found, m.
    along: f32,
    ends: [Option<f32>; 2],
    /// Place at which the range fell off in the pass along the pipe, m, and the time without the pipe at the end of
    /// the pass.
    fell: Option<f32>,
    lost: HoldTimer,
    /// The pipe was crossed at this height, and its ends were searched.
    crossed: bool,
    looked: bool,
    settled: HoldTimer,
    /// Low-passed speed across, m/s.
    slow: f32,
    left: bool,
    /// The place of the pipe is reported: the search is skipped.
    has_target: bool,
    /// Commanded horizontal velocity, m/s.
    speed: [f32; 2],
}

impl ApproachPlanner {
    /// An attempt from the present position, over or beside a pipe along `heading`, rad.
    pub fn begin(p: &Params, v: &View, heading: f32, reset_count: u8) -> Self {
        let planner = Self {
            diameter: p.pipe_diameter,
            lens: p.flow_lens(),
            origin: v.position,
            heading,
            reset_count,
            phase: Phase::Search,
            since: 0.0,
            leaves: false,
            returns: false,
            up: -RISE,
            edges: Edges::default(),
            seen: v.range_hit.count,
            steps: [f32::INFINITY; 2],
            first_off: false,
            farthest: 0.0,
            other: None,
            middle: Vec3::ZERO,
            side: 1.0,
            reach: SWEEP,
            legs: 0,
            entered: None,
            met: None,
            crown_y: 0.0,
            crown_z: 0.0,
            half: 0.5 * p.pipe_diameter,
            crown_crossed: false,
            along: 0.0,
            ends: [None; 2],
            fell: None,
            lost: HoldTimer::default(),
            crossed: false,
            looked: false,
            settled: HoldTimer::default(),
            slow: 0.0,
            left: false,
            has_target: false,
            speed: [0.0; 2],
        };
        match &v.target {
            Some(target) => planner.to(target),
            None => planner,
        }
    }

    /// An attempt that climbs first; with `leaves` it only leaves the pipe.
    pub fn again(p: &Params, v: &View, heading: f32, reset_count: u8, leaves: bool) -> Self {
        Self {
            phase: Phase::Climb,
            leaves,
            returns: true,
            up: if leaves { -HIGH } else { -RISE },
            ..Self::begin(p, v, heading, reset_count)
        }
    }

    /// An attempt that climbs to `HIGH` over `crown_position`, as last known, and sweeps about it: an escape has
    /// carried the vehicle a metre or two away.
    pub fn back_to(crown_position: Vec3, p: &Params, v: &View, heading: f32, reset_count: u8) -> Self {
        let planner = Self::again(p, v, heading, reset_count, false);
        let off = planner.local(crown_position);
        Self {
            up: clamp(off.z - HIGH, -2.0 * HIGH, 0.0),
            middle: Vec3::new(off.x, off.y, 0.0),
            side: if off.y > 0.0 { 1.0 } else { -1.0 },
            ..planner
        }
    }

    /// It needs the place of the pipe that a companion says.
    pub fn asks_target(&self) -> bool {
        self.has_target && self.asks()
    }

    /// It needs to see the pipe, or to be told where it is.
    fn asks(&self) -> bool {
        !self.leaves && self.phase != Phase::Commit
    }

    /// Position of the crown in the estimate's axes, m; `None` before the descent.
    pub fn crown_position(&self) -> Option<Vec3> {
        let position = about_down(self.above_crown(0.0), self.heading) + self.origin;
        self.committed().then_some(position)
    }

    /// A climb after a misleading range, to leave the pipe: no higher than flow sees the ground.
    pub fn cleared(&self, p: &Params, v: &View, heading: f32, reset_count: u8) -> Self {
        let ground = self.edges.ground_depth();
        let height = ground.map_or(self.farthest, |ground| ground - self.local(v.position).z);
        Self {
            up: -clamp(CEILING - height, 0.0, CLEAR),
            ..Self::again(p, v, heading, reset_count, true)
        }
    }

    /// Another attempt from above, over the crown if it is known. A planner that leaves the pipe keeps leaving it.
    pub fn retried(&self, p: &Params, v: &View, heading: f32, reset_count: u8) -> Self {
        let again = Self::again(p, v, heading, reset_count, self.leaves);
        if self.leaves {
            return again;
        }
        let known = !matches!(self.phase, Phase::Climb | Phase::Search);
        let top = if known { self.crown_z } else { self.edges.top() };
        let over = self.origin.z + top - HIGH - v.position.z;
        Self {
            has_target: self.has_target,
            steps: self.steps,
            farthest: self.farthest,
            up: clamp(over, -2.0 * HIGH, 0.0),
            ..again
        }
    }

    /// A contact in this phase is with the pipe.
    pub fn committed(&self) -> bool {
        matches!(self.phase, Phase::Descend | Phase::Commit)
    }

    /// The descent is so near that only the pipe's back can be below.
    pub fn near_crown(&self, v: &View) -> bool {
        let at = self.local(v.position);
        let over = (at.y - self.crown_y).abs() < NEAR_OFF;
        self.phase == Phase::Descend && !self.has_target && over && self.clearance(at) < STEADY
    }

    /// The vehicle climbs.
    pub fn climbs(&self) -> bool {
        self.phase == Phase::Climb
    }

    /// The vehicle only leaves the pipe.
    pub fn leaves(&self) -> bool {
        self.leaves
    }

    /// The vehicle has climbed off the pipe.
    pub fn has_left(&self) -> bool {
        self.left
    }

    /// Horizontal direction off the pipe for a vehicle at `position`, length 1, in the estimate's axes: across, to the
    /// nearer side. `None` before an object is met.
    pub fn off_pipe(&self, position: Vec3) -> Option<Vec3> {
        let here = self.local(position).y;
        let off = match (self.phase, self.met) {
            (Phase::Search, Some(met)) => here - met,
            // Over an object from the beginning: continue in the direction of the sweep.
            (Phase::Search, None) if self.origin.z + self.edges.surface_depth() < -RAISED => self.side,
            (Phase::Search, None) => return None,
            _ => here - self.crown_y,
        };
        let side = if off < 0.0 { -1.0 } else { 1.0 };
        Some(about_down(Vec3::new(0.0, side, 0.0), self.heading))
    }

    /// Origin of the estimate's axes has jumped since the beginning.
    pub fn jumped(&self, reset_count: u8) -> bool {
        self.reset_count != reset_count
    }

    /// One step of `dt` s: the velocity command.
    ///
    /// # Errors
    /// The reason for which the attempt ends.
    pub fn step(&mut self, v: &View, dt: f32) -> Result<VelocityCommand, ApproachAbort> {
        self.since += dt;
        let asks = self.asks();
        if asks && self.has_target {
            self.follow(v, dt)?;
        } else if asks && v.range_hit.age > RANGE_AGE {
            return Err(ApproachAbort::RangeStale);
        }
        let before = self.edges.surface_depth();
        let step = self.take_range(v).filter(|_| !self.has_target);
        if let (Some((Edge::Off(_), true)), true) = (step, self.first_off) {
            let [_, off] = &mut self.steps;
            *off = self.edges.height().unwrap_or(f32::INFINITY);
        }
        self.first_off &= step.is_none_or(|(_, continues)| continues);
        let at = self.local(v.position);
        if let Some((edge, continues)) = step {
            // What began as too low a step may have been a part of it.
            let whole = continues && self.compare(edge, at).is_ok();
            self.other = self.other.filter(|other| !whole && !self.at_known(other.from));
            // A step onto something is compared as it begins: with a jump of the range just before it would be too high.
            let again = continues && matches!(edge, Edge::Onto(_));
            let judged = asks && !self.climbs() && !again;
            let found = self.compare(edge, at).err().filter(|_| judged);
            let found = found.map(|doubt| Other {
                doubt,
                from: before,
                seconds: 0.0,
            });
            self.other = self.other.or(found);
        }
        if let Some(other) = &mut self.other {
            other.seconds += dt;
            if other.seconds > LASTING {
                return Err(other.doubt);
            }
        }
        let edge = step.map(|(edge, _)| edge);
        let held = self.local(v.held);
        let velocity = about_down(v.velocity, -self.heading);
        let wanted = match self.phase {
            Phase::Climb => Ok(self.climb(at, held)),
            Phase::Search => self.search(edge, held),
            Phase::Over => self.over(at, held, scalar::wrap_pi(self.heading - v.heading)),
            Phase::Fore | Phase::Aft => self.look_along(edge, held, dt),
            Phase::Cross => self.cross(edge, held),
            Phase::Centre => self.centre(edge, at, held),
            Phase::Descend => self.descend(edge, (at, velocity, held), v.age, dt),
            Phase::Commit => self.commit(at, held),
        };
        // The abort reason of a doubtful range has precedence over its consequences.
        let wanted = wanted.map_err(|doubt| self.other.map_or(doubt, |other| other.doubt))?;
        let [x, y] = self.speed;
        let (x, y) = (
            scalar::slew(x, wanted.x, SLEW * dt),
            scalar::slew(y, wanted.y, SLEW * dt),
        );
        self.speed = [x, y];
        let off = scalar::wrap_pi(self.heading - v.heading);
        Ok(VelocityCommand {
            velocity: about_down(Vec3::new(x, y, wanted.z), -off),
            yaw_rate: clamp_abs(HEADING_GAIN * off, YAW_RATE_MAX),
            lean: [0.0; 2],
        })
    }

    fn local(&self, place: Vec3) -> Vec3 {
        about_down(place - self.origin, -self.heading)
    }

    fn enter(&mut self, phase: Phase) {
        self.phase = phase;
        self.since = 0.0;
        (self.entered, self.fell) = (None, None);
        (self.settled, self.lost) = Default::default();
    }

    fn late(&self, limit: f32, doubt: ApproachAbort) -> Result<(), ApproachAbort> {
        if self.since > limit { Err(doubt) } else { Ok(()) }
    }

    /// The step that a new range shows.
    fn take_range(&mut self, v: &View) -> Option<(Edge, bool)> {
        if v.range_hit.count == self.seen {
            return None;
        }
        self.seen = v.range_hit.count;
        let range = v
            .range_hit
            .surface_point
            .map_or(0.0, |point| point.z - v.position.z);
        self.farthest = self.farthest.max(range);
        match v.range_hit.surface_point {
            Some(point) => self.edges.step(self.local(point), range),
            // No target in reach: farther than every surface.
            None => self.edges.step_beyond(self.local(v.position)),
        }
    }

    /// The present surface is `before`, m down, again, or the pipe, or the ground at its sides.
    fn at_known(&self, before: f32) -> bool {
        let [onto, off] = self.steps.map(|step| self.crown_z + step);
        let near = |known: f32| (self.edges.surface_depth() - known).abs() < 0.5 * self.diameter;
        self.sees_pipe() || [before, onto, off].into_iter().any(near)
    }

    /// Compares the step at `edge`, seen from `at`, with the steps of the first crossing.
    fn compare(&self, edge: Edge, at: Vec3) -> Result<(), ApproachAbort> {
        let [onto, off] = self.steps;
        if !(onto + off).is_finite() {
            return Ok(());
        }
        let most = onto.max(off);
        let falls = matches!(edge, Edge::Off(_));
        let from_crown = |step| self.edges.surface_depth() - step - self.edges.top() < 0.5 * self.diameter;
        match self.edges.height() {
            Some(step) if step > HIGHER * most + 0.5 * self.diameter => Err(ApproachAbort::RangeLong),
            Some(step) if falls && from_crown(step) && step < LOWEST * onto.min(off) => {
                Err(ApproachAbort::RangeMisfit)
            }
            // From this height the surface was within reach before.
            None if falls && self.edges.top() + most - at.z < self.farthest => Err(ApproachAbort::RangeLong),
            _ => Ok(()),
        }
    }

    /// Velocity from the held point to `target`, horizontally at most `speed` and vertically at most `climb`, m/s.
    fn velocity_towards(held: Vec3, target: Vec3, speed: f32, climb: f32) -> Vec3 {
        let off = target - held;
        Vec3::new(
            braking_speed(off.x, speed),
            braking_speed(off.y, speed),
            clamp_abs(HEIGHT_GAIN * off.z, climb),
        )
    }

    fn climb(&mut self, at: Vec3, held: Vec3) -> Vec3 {
        let target = Vec3::new(0.0, 0.0, self.up);
        if (at.z - self.up).abs() < OVER || self.since > WAY_TIME {
            self.left = self.leaves;
            self.enter(if self.has_target {
                Phase::Over
            } else {
                Phase::Search
            });
        }
        Self::velocity_towards(held, target, CROSS_SPEED, CLIMB_SPEED)
    }

    /// Middle of the pipe, right, m, if this `edge` ends a crossing.
    fn crossed(&mut self, edge: Option<Edge>) -> Option<f32> {
        match (edge?, self.entered) {
            (Edge::Onto(at), _) => {
                self.entered = Some(at.y);
                let [onto, off] = &mut self.steps;
                if off.is_infinite() {
                    *onto = self.edges.height().unwrap_or(f32::INFINITY);
                }
                None
            }
            (Edge::Off(at), Some(from)) => {
                self.entered = None;
                let width = (at.y - from).abs();
                let (least, most) = WIDTH;
                if !(least * self.diameter..=most * self.diameter).contains(&width) {
                    return None;
                }
                (self.half, self.crown_z) = (0.5 * width, self.edges.top());
                let [onto, off] = &mut self.steps;
                if onto.is_finite() && off.is_infinite() {
                    self.first_off = true;
                    *off = self.edges.height().unwrap_or(f32::INFINITY);
                }
                Some(0.5 * (at.y + from))
            }
            (Edge::Off(_), None) => None,
        }
    }

    fn search(&mut self, edge: Option<Edge>, held: Vec3) -> Result<Vec3, ApproachAbort> {
        self.late(SEARCH_TIME, ApproachAbort::NoPipe)?;
        self.met = match edge {
            Some(Edge::Onto(at)) => Some(at.y + self.side * self.half),
            Some(Edge::Off(at)) => Some(at.y - self.side * self.half),
            None => self.met,
        };
        if let Some(middle) = self.crossed(edge) {
            self.crown_y = middle;
            self.along = held.x;
            self.enter(Phase::Over);
        }
        // A crossing that has entered the pipe continues to its far edge.
        let beyond = self.entered.map_or(0.0, |_| self.diameter);
        let across = self.side * (self.reach + beyond) - self.lens.y;
        let target = self.middle + Vec3::new(0.0, across, held.z);
        if (target.y - held.y).abs() < REACHED {
            self.reach += if self.side < 0.0 { SWEEP } else { 0.0 };
            self.side = -self.side;
            if self.reach > SWEEP_MAX {
                return Err(ApproachAbort::NoPipe);
            }
        }
        Ok(Self::velocity_towards(held, target, SWEEP_SPEED, 0.0))
    }

    /// The point `height` m above the crown.
    fn above_crown(&self, height: f32) -> Vec3 {
        Vec3::new(self.along, self.crown_y, self.crown_z - height)
    }

    fn over(&mut self, at: Vec3, held: Vec3, askew: f32) -> Result<Vec3, ApproachAbort> {
        self.late(WAY_TIME, ApproachAbort::NotCentred)?;
        let target = self.above_crown(LOW);
        let off = target - at;
        if off.y.abs() < OVER && off.z.abs() < OVER && self.since > OVER_TIME {
            if self.has_target {
                if off.x.abs() < OVER && askew.abs() < ALONG {
                    self.enter(Phase::Centre);
                }
            } else if self.crossed {
                self.ends = [None; 2];
                self.enter(Phase::Fore);
            } else {
                self.turn_across();
            }
        }
        Ok(Self::velocity_towards(held, target, CROSS_SPEED, DESCENT))
    }

    /// Begins the crossings.
    fn turn_across(&mut self) {
        (self.side, self.legs, self.crown_crossed) = (1.0, 0, false);
        self.enter(Phase::Cross);
    }

    /// The range sees the pipe's back.
    fn sees_pipe(&self) -> bool {
        self.has_target || (self.edges.surface_depth() - self.crown_z).abs() < 0.5 * self.diameter
    }

    fn look_along(&mut self, edge: Option<Edge>, held: Vec3, dt: f32) -> Result<Vec3, ApproachAbort> {
        self.late(WAY_TIME, ApproachAbort::NotCentred)?;
        let fore = self.phase == Phase::Fore;
        let middle = self.middle.x;
        let goal = middle + if fore { LOOK } else { -LOOK };
        // The beam follows the crown, not the vehicle.
        let Vec3 { x, y, .. } = self.lens;
        let target = Vec3::new(goal - x, self.crown_y - y, self.crown_z - LOW);
        // A gust may carry the beam off the side: a pipe that the beam returns to has not ended.
        match edge {
            Some(Edge::Off(at)) => self.fell = Some(at.x),
            Some(Edge::Onto(_)) => self.fell = None,
            None => (),
        }
        let there = (target.x - held.x).abs() < REACHED;
        let sees = self.sees_pipe();
        self.lost.step(there && !sees, dt);
        if there && (sees || self.lost.time() >= END_TIME) {
            let end = if sees {
                None
            } else {
                Some(self.fell.unwrap_or(held.x + x))
            };
            let [front, rear] = &mut self.ends;
            *(if fore { front } else { rear }) = end;
            if fore {
                self.enter(Phase::Aft);
            } else {
                let [front, rear] = self.ends;
                let most = front.map_or(middle + LOOK, |end| end - END);
                let least = rear.map_or(middle - LOOK, |end| end + END);
                if most < least {
                    return Err(ApproachAbort::TooShort);
                }
                self.along = clamp(middle, least, most);
                self.looked = true;
                self.turn_across();
            }
        }
        Ok(Self::velocity_towards(held, target, CROSS_SPEED, DESCENT))
    }

    fn cross(&mut self, edge: Option<Edge>, held: Vec3) -> Result<Vec3, ApproachAbort> {
        self.late(2.0 * WAY_TIME, ApproachAbort::NotCentred)?;
        if let Some(middle) = self.crossed(edge) {
            if self.crown_crossed && (self.crown_y - middle).abs() > AGREE {
                return Err(ApproachAbort::NotCentred);
            }
            (self.crown_crossed, self.crown_y) = (true, middle);
        }
        let mut target = self.above_crown(LOW);
        target.y += self.side * (self.half + BESIDE) - self.lens.y;
        if (target.y - held.y).abs() < REACHED {
            self.side = -self.side;
            self.legs = self.legs.saturating_add(1);
            if self.legs >= LEGS {
                if !self.crown_crossed {
                    return Err(ApproachAbort::PipeLost);
                }
                self.crossed = true;
                self.enter(if self.looked { Phase::Centre } else { Phase::Over });
            }
        }
        Ok(Self::velocity_towards(held, target, CROSS_SPEED, DESCENT))
    }

    fn centre(&mut self, edge: Option<Edge>, at: Vec3, held: Vec3) -> Result<Vec3, ApproachAbort> {
        self.late(CENTRE_TIME, ApproachAbort::NotCentred)?;
        match edge {
            // The vehicle comes from the side at which the last crossing ended, so that the edge shows the drift
            // since.
            Some(Edge::Onto(onto)) => {
                let inwards = if onto.y < self.crown_y {
                    self.half
                } else {
                    -self.half
                };
                let middle = onto.y + inwards;
                if (middle - self.crown_y).abs() > AGREE {
                    return Err(ApproachAbort::NotCentred);
                }
                self.crown_y += NEWER * (middle - self.crown_y);
            }
            // A gust carries the beam off the side.
            Some(Edge::Off(_)) | None => (),
        }
        // The vehicle settles during the descent: each second here costs a centimetre of the edge's accuracy.
        if (at.y - self.crown_y).abs() < NEAR_OFF && self.sees_pipe() {
            self.enter(Phase::Descend);
        }
        Ok(Self::velocity_towards(
            held,
            self.above_crown(LOW),
            CROSS_SPEED,
            DESCENT,
        ))
    }

    fn descend(
        &mut self,
        edge: Option<Edge>,
        (at, velocity, held): (Vec3, Vec3, Vec3),
        age: f32,
        dt: f32,
    ) -> Result<Vec3, ApproachAbort> {
        self.late(GATE_WAIT, ApproachAbort::NotCentred)?;
        if matches!(edge, Some(Edge::Off(_))) || !self.sees_pipe() {
            return Err(ApproachAbort::PipeLost);
        }
        let off = at.y - self.crown_y;
        let range = self.clearance(at);
        let share = clamp(self.since / PATIENCE, 0.0, 1.0);
        let within = STRICT + (CONTENT - STRICT) * share;
        // Predicted offset at the touch: half of the latest change of speed persists.
        let gained = velocity.y - self.slow;
        self.slow += gained * dt / (dt + SLOW_TIME);
        let ahead = off + LAST_TIME * (velocity.y + LAST_TIME / (4.0 * SLOW_TIME) * gained);
        let over = off.abs() < CONTENT && ahead.abs() < within && velocity.y.abs() < GATE_SPEED;
        let blind = age > BLIND;
        // Predicted range at the stop: the vehicle must not pass the gate before the touch is certain to be on the
        // crown.
        let stops = range - STOP_TIME * velocity.z;
        let at_gate = stops < 1.3 * GATE;
        if self.settled.step(at_gate && over && !blind, dt) >= GATE_TIME {
            self.enter(Phase::Commit);
        }
        let mut command = Self::velocity_towards(held, self.above_crown(LOW), CORRECT_SPEED, DESCENT);
        let waits = off.abs() > NEAR_OFF;
        // Flow works again from a little higher. A pose may not return: the vehicle must not drift beside the pipe.
        let (goal, back) = match (blind, self.has_target) {
            (false, _) => (GATE, BACK_SPEED),
            (true, false) => (SEEING, BACK_SPEED),
            (true, true) => (LOW, CLIMB_SPEED),
        };
        let braked = HEIGHT_GAIN * (self.clearance(held).min(stops) - goal);
        command.z = if waits && range < NEAR && !blind {
            0.0
        } else {
            clamp(braked, -back, DESCENT)
        };
        Ok(command)
    }

    fn commit(&mut self, at: Vec3, held: Vec3) -> Result<Vec3, ApproachAbort> {
        self.late(TOUCH_WAIT, ApproachAbort::NotTouched)?;
        if (at.y - self.crown_y).abs() > ASTRAY {
            return Err(ApproachAbort::NotCentred);
        }
        let mut command = Self::velocity_towards(held, self.above_crown(LOW), CORRECT_SPEED, DESCENT);
        command.z = LAST_SPEED;
        Ok(command)
    }
}

/// Speed towards a target `off` m away from which a stop at [`SLEW`] still ends there, at most `speed`, m/s.
fn braking_speed(off: f32, speed: f32) -> f32 {
    let most = 1.6 * SLEW * off.abs();
    let braked = most * scalar::inv_sqrt(most);
    clamp(braked, 0.0, speed) * if off < 0.0 { -1.0 } else { 1.0 }
}
