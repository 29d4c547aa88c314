//! Planner of the autonomous approach, 100 Hz: finds the crown by range steps, searches the pipe's ends, and descends
//! over the crown. It commands velocities, as the sticks do in a hold; docs/hold.md describes it.
//!
//! Lengths are relative to the beginning of an attempt: forward and right along its heading, down.

#[cfg(test)]
mod tests;
mod to_target;

use crate::approach::limits::*;
use crate::approach::pipe_edges::{Edge, PipeEdges};
use crate::approach::pipe_target::PipeTarget;
use crate::maths::frames::about_down;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::{self, clamp, clamp_abs};
use crate::maths::vector::Vec3;
use crate::navigation::estimate::SurfaceLevels;
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
    /// Ground or pipe are no longer at the level at which the vehicle has crossed them.
    RangeMisfit,
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
    /// Levels of the surfaces below.
    pub levels: SurfaceLevels,
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
    edges: PipeEdges,
    seen: u8,
    /// Levels of ground and pipe at the first crossing, m down in the estimate's axes.
    crossed_levels: Option<[f32; 2]>,
    /// Middle of the sweeps, forward and right, m; side of the present leg, half the sweep's width, m, and legs flown.
    middle: [f32; 2],
    side: f32,
    reach: f32,
    legs: u8,
    /// Place at which the range came onto the pipe, right, m.
    entered: Option<f32>,
    /// Middle of the object that the search met last, by one of its edges, right, m.
    met: Option<f32>,
    /// The pipe's crown, right and down, m, the variance of the former, m², and half the pipe's width, m.
    crown_y: f32,
    crown_z: f32,
    crown_variance: f32,
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
            edges: PipeEdges::default(),
            seen: v.range_hit.count,
            crossed_levels: None,
            middle: [0.0; 2],
            side: 1.0,
            reach: SWEEP,
            legs: 0,
            entered: None,
            met: None,
            crown_y: 0.0,
            crown_z: 0.0,
            crown_variance: 0.0,
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
        Self::again(p, v, heading, reset_count, false).about(crown_position)
    }

    /// The search is about `crown_position`, as last known, from [`HIGH`] above it.
    fn about(self, crown_position: Vec3) -> Self {
        let off = self.local(crown_position);
        Self {
            up: clamp(off.z - HIGH, -2.0 * HIGH, 0.0),
            middle: [off.x, off.y],
            side: if off.y > 0.0 { 1.0 } else { -1.0 },
            ..self
        }
    }

    /// It needs the place of the pipe that a companion says.
    pub fn asks_target(&self) -> bool {
        self.has_target && self.asks()
    }

    /// It needs the range, or the reported place of the pipe.
    fn asks(&self) -> bool {
        !self.leaves && self.phase != Phase::Commit
    }

    /// Position of the crown in the estimate's axes, m; `None` before the descent.
    pub fn crown_position(&self) -> Option<Vec3> {
        self.committed().then_some(self.crown())
    }

    fn crown(&self) -> Vec3 {
        about_down(self.above_crown(0.0), self.heading) + self.origin
    }

    /// A climb after a misleading range, to leave the pipe: no higher than flow sees the ground.
    pub fn cleared(&self, p: &Params, v: &View, heading: f32, reset_count: u8) -> Self {
        let height = v.levels.ground - v.position.z;
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
        let again = Self {
            has_target: self.has_target,
            ..again
        };
        if matches!(self.phase, Phase::Climb | Phase::Search) {
            // Higher than the surface below.
            let top = v.levels.raised.unwrap_or(v.levels.ground);
            let up = clamp(top - HIGH - v.position.z, -2.0 * HIGH, 0.0);
            Self { up, ..again }
        } else {
            again.about(self.crown())
        }
    }

    /// A contact in this phase is with the pipe.
    pub fn committed(&self) -> bool {
        matches!(self.phase, Phase::Descend | Phase::Commit)
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
            (Phase::Search, None) if self.edges.on() => self.side,
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
        let edge = self.take_range(v).filter(|_| !self.has_target);
        self.crown_variance += DRIFT * DRIFT * dt;
        if !self.has_target {
            // Another try is about the crown that was known.
            if asks && self.is_misfit(&v.levels) {
                return Err(ApproachAbort::RangeMisfit);
            }
            self.crown_z = v
                .levels
                .raised
                .map_or(self.crown_z, |level| level - self.origin.z);
        }
        let at = self.local(v.position);
        let held = self.local(v.held);
        let velocity = about_down(v.velocity, -self.heading);
        let wanted = match self.phase {
            Phase::Climb => self.climb(at, held),
            Phase::Search => self.search(edge, held, &v.levels)?,
            Phase::Over => self.over(at, held, scalar::wrap_pi(self.heading - v.heading))?,
            Phase::Fore | Phase::Aft => self.look_along(edge, held, dt)?,
            Phase::Cross => self.cross(edge, held)?,
            Phase::Centre => self.centre(edge, at, held)?,
            Phase::Descend => self.descend(edge, (at, velocity, held), v.age, dt)?,
            Phase::Commit => self.commit(at, held)?,
        };
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

    /// The edge that a new range shows.
    fn take_range(&mut self, v: &View) -> Option<Edge> {
        if v.range_hit.count == self.seen {
            return None;
        }
        self.seen = v.range_hit.count;
        let hit = RangeHit {
            surface_point: v.range_hit.surface_point.map(|point| self.local(point)),
            lens: self.local(v.range_hit.lens),
            beam: about_down(v.range_hit.beam, -self.heading),
            ..v.range_hit
        };
        let levels = SurfaceLevels {
            ground: v.levels.ground - self.origin.z,
            raised: v.levels.raised.map(|level| level - self.origin.z),
        };
        self.edges.take(&hit, &levels, 0.5 * self.diameter)
    }

    /// Since the first crossing the ground has risen, or the pipe has another level, or none.
    fn is_misfit(&self, levels: &SurfaceLevels) -> bool {
        let Some([ground, pipe]) = self.crossed_levels else {
            return false;
        };
        let elsewhere = |level: f32| (level - pipe).abs() > MISFIT;
        ground - levels.ground > MISFIT || levels.raised.is_none_or(elsewhere)
    }

    /// Moves the crown to `y`, which is known to `variance`, m²; false if it cannot be there.
    fn follow_crown(&mut self, y: f32, variance: f32) -> bool {
        let off = y - self.crown_y;
        let total = self.crown_variance + variance;
        if off.abs() > AGREE && off * off > AGREE_DEVIATIONS * AGREE_DEVIATIONS * total {
            return false;
        }
        self.crown_y += off * self.crown_variance / total;
        self.crown_variance *= variance / total;
        true
    }

    /// Follows the crown by an edge of one of its sides, of which the beam's way says which it is; what it passes lengthwise near
    /// the crown is an end of the pipe. False if it cannot be there.
    fn follow_edge(&mut self, edge: Option<Edge>) -> bool {
        let Some(Edge { at, way, onto }) = edge else {
            return true;
        };
        let off = at.y - self.crown_y;
        if off.abs() < ASIDE * self.half && way.x.abs() > AHEAD * way.y.abs() {
            return true;
        }
        let side = if (way.y < 0.0) == onto { 1.0 } else { -1.0 };
        self.follow_crown(at.y - side * self.half, EDGE * EDGE)
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

    /// Middle of the pipe and half its width, right, m, if this `edge` ends a crossing.
    fn crossed(&mut self, edge: Option<Edge>) -> Option<(f32, f32)> {
        let Edge { at, onto, .. } = edge?;
        if onto {
            self.entered = Some(at.y);
            return None;
        }
        let from = self.entered.take()?;
        let width = (at.y - from).abs();
        let (least, most) = WIDTH;
        let sound = (least * self.diameter..=most * self.diameter).contains(&width);
        sound.then_some((0.5 * (at.y + from), 0.5 * width))
    }

    fn search(
        &mut self,
        edge: Option<Edge>,
        held: Vec3,
        levels: &SurfaceLevels,
    ) -> Result<Vec3, ApproachAbort> {
        self.late(SEARCH_TIME, ApproachAbort::NoPipe)?;
        self.met = match edge {
            Some(Edge { at, onto: true, .. }) => Some(at.y + self.side * self.half),
            Some(Edge { at, onto: false, .. }) => Some(at.y - self.side * self.half),
            None => self.met,
        };
        if let Some((middle, half)) = self.crossed(edge) {
            (self.crown_y, self.half, self.crown_variance) = (middle, half, 0.5 * EDGE * EDGE);
            self.along = held.x;
            let crossed = levels.raised.map(|pipe| [levels.ground, pipe]);
            self.crossed_levels = self.crossed_levels.or(crossed);
            self.enter(Phase::Over);
        }
        // A crossing that has entered the pipe, whose level may not be known yet, continues to its far edge.
        let beyond = if self.entered.is_some() || self.edges.on() {
            self.diameter
        } else {
            0.0
        };
        let across = self.side * (self.reach + beyond) - self.lens.y;
        let [x, y] = self.middle;
        let target = Vec3::new(x, y + across, held.z);
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
        self.has_target || self.edges.on()
    }

    fn look_along(&mut self, edge: Option<Edge>, held: Vec3, dt: f32) -> Result<Vec3, ApproachAbort> {
        self.late(WAY_TIME, ApproachAbort::NotCentred)?;
        let fore = self.phase == Phase::Fore;
        let [middle, _] = self.middle;
        let goal = middle + if fore { LOOK } else { -LOOK };
        // The beam follows the crown, not the vehicle.
        let Vec3 { x, y, .. } = self.lens;
        let target = Vec3::new(goal - x, self.crown_y - y, self.crown_z - LOW);
        // A gust may carry the beam off the side: a pipe that the beam returns to has not ended.
        self.fell = match edge {
            Some(Edge { at, onto: false, .. }) => Some(at.x),
            Some(Edge { onto: true, .. }) => None,
            None => self.fell,
        };
        self.follow_edge(edge);
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
        if let Some((middle, half)) = self.crossed(edge) {
            // One from this height says more than the one of the search.
            if !core::mem::replace(&mut self.crown_crossed, true) {
                (self.crown_y, self.half, self.crown_variance) = (middle, half, 0.5 * EDGE * EDGE);
            } else if self.follow_crown(middle, 0.5 * EDGE * EDGE) {
                self.half += 0.5 * (half - self.half);
            } else {
                return Err(ApproachAbort::NotCentred);
            }
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
        // The vehicle comes from the side at which the last crossing ended: the edge shows the drift since.
        if !self.follow_edge(edge) {
            return Err(ApproachAbort::NotCentred);
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
        // A beam that leaves the pipe shows where the crown is, unless it does not come back.
        let sees = self.sees_pipe();
        if !self.follow_edge(edge) || self.lost.step(!sees, dt) > END_TIME {
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
        command.z = if !sees || (waits && range < NEAR && !blind) {
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
