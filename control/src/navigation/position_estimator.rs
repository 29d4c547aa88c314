//! Position, velocity and disturbance at 200 Hz, from the inertial sensor and delayed external poses, or without poses
//! from optical flow and range.
//!
//! The axes are those of the poses' sender: down is the vehicle's, the heading differs by an estimated yaw offset (the
//! vehicle has no compass, and a visual odometry drifts). With flow alone the origin is the place of the first flow.
//! docs/design/navigation.md has derivation and figures.

#[cfg(test)]
mod tests;

use crate::maths::elapsed::seconds;
use crate::maths::frames::about_down;
use crate::maths::scalar::{self, GRAVITY};
use crate::maths::vector::Vec3;
use crate::navigation::air_pressure::AirPressure;
use crate::navigation::axis_filter::{Axis, Change, DOWN, LEANING};
use crate::navigation::baro_height::{BaroHeight, PressureFault};
use crate::navigation::estimate::{Estimate, SurfaceLevels};
use crate::navigation::external_pose::{ExternalPoseMonitor, PoseFault, TURN_GAIN, TURN_STEP};
use crate::navigation::fix::Fix;
use crate::navigation::fix_age::{DEAD_RECKONING_INVALID_AGE, HEIGHT_AGE, LOST_AGE, UNKNOWN_AGE};
use crate::navigation::flow_range::{FlowRangeFault, FlowRangeFusion, Frame, beam};
use crate::navigation::flow_range_sample::{Flow, GroundView};
use crate::navigation::history::{StateHistory, StateSnapshot};
use crate::navigation::inertial::{Inertial, STEP_MAX};
use crate::navigation::range_hit::RangeHit;
use crate::navigation::vertical_speed::{VerticalSpeed, VerticalState};
use crate::params::Params;

/// Fixes before the estimate is published, half a second at 50 Hz, and the largest deviation of the velocity then,
/// m/s.
const READY_FIXES: u32 = 25;
const READY_SPEED: f32 = 0.1;
/// Least deviation of a bias that is kept over a restart of the estimate, as after a perch, m/s²: horizontally that of the
/// attitude, 0.6°, down that of the sensor alone.
const KEPT_BIAS: [f32; 3] = [0.1, 0.1, 0.03];
/// Largest bias that is kept, m/s²: a larger one comes from an estimate with inconsistent flow.
const SENSOR_BIAS: f32 = 0.3;
/// Thrust over weight beyond which the rotors carry the vehicle.
pub const FLIES: f32 = 0.5;
/// Age of the newest pose beyond which flow and range are fused, s.
const POSE_FRESH: f32 = 0.2;
/// Flows refused in a row after which the next one resets the velocity, a second at 50 Hz; a permanently wrong flow is
/// found by its disagreement with the inertial sensor.
const FLOWS_REFUSED_MAX: u32 = 50;
/// Range below which the vehicle stands, m, and the variance of its horizontal speed then, (m/s)².
const STANDING: f32 = 0.05;
const STAND_SPEED: f32 = 0.01;
/// Variance of a vertical speed of zero at rest, (m/s)².
const REST_SPEED: f32 = 0.01;
/// Cut-off of the lateral disturbance, rad/s.
pub const LATERAL_CUTOFF: f32 = 20.0;
/// Cut-off of the vertical one, rad/s.
const VERTICAL_CUTOFF: f32 = 8.0;

/// A source that is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The poses.
    Pose(PoseFault),
    /// Flow or range.
    FlowRange(FlowRangeFault),
    /// The pressure of the air.
    Pressure(PressureFault),
}

impl Fault {
    /// For the pilot's display: at most 40 ASCII characters.
    pub const fn text(self) -> &'static str {
        match self {
            Self::Pose(fault) => fault.text(),
            Self::FlowRange(fault) => fault.text(),
            Self::Pressure(fault) => fault.text(),
        }
    }
}

/// The estimator.
#[derive(Clone, Debug)]
pub struct PositionEstimator {
    mass: f32,
    motor_tau: f32,
    history: StateHistory,
    /// `None` before the first fix and after the last one has aged.
    track: Option<Track>,
    flow_range: FlowRangeFusion,
    pose_monitor: ExternalPoseMonitor,
    baro_height: BaroHeight,
    vertical_speed: VerticalSpeed,
    /// Time of the last step, µs.
    at_us: u64,
    /// End of the last track by flow, µs, and its axes, whose biases seed the next track.
    learnt: Option<(u64, [Axis; 3])>,
    /// Measurement times of the newest fix and the newest flow processed, µs: each is processed once.
    seen_us: u64,
    flow_us: u64,
}

impl PositionEstimator {
    /// An estimator without a fix.
    pub fn new(p: &Params) -> Self {
        Self {
            mass: p.mass,
            motor_tau: p.motor_tau,
            history: StateHistory::default(),
            track: None,
            flow_range: FlowRangeFusion::new(p.pipe_diameter, p.flow_lens()),
            pose_monitor: ExternalPoseMonitor::default(),
            baro_height: BaroHeight::default(),
            vertical_speed: VerticalSpeed::default(),
            at_us: 0,
            learnt: None,
            seen_us: 0,
            flow_us: 0,
        }
    }

    /// The source rejected at present, with or without an estimate.
    pub fn fault(&self) -> Option<Fault> {
        let pose = self.pose_monitor.fault().map(Fault::Pose);
        pose.or_else(|| self.flow_range.fault().map(Fault::FlowRange))
            .or_else(|| self.baro_height.fault().map(Fault::Pressure))
    }

    /// Takes the newest air pressure for the next step, as the height of last resort. It is optional.
    pub fn hear(&mut self, air: &AirPressure) {
        self.baro_height.hear(air);
    }

    /// One step with the inertial sensor, the thrust demanded along -z, N, the newest fix and the newest flow and
    /// range. `None` without a position.
    pub fn step(
        &mut self,
        inertial: &Inertial,
        lift: f32,
        fix: Option<&Fix>,
        view: Option<&GroundView>,
    ) -> Option<Estimate> {
        let at_us = inertial.at_us;
        let new = fix.filter(|fix| fix.at_us > self.seen_us && fix.at_us <= at_us && fix.is_sane());
        self.seen_us = new.map_or(self.seen_us, |fix| fix.at_us);
        let flow = view.and_then(|view| view.flow).and_then(Flow::checked);
        let flow = flow.filter(|flow| flow.until_us > self.flow_us && flow.until_us <= at_us);
        self.flow_us = flow.map_or(self.flow_us, |flow| flow.until_us);
        let flies = lift > FLIES * GRAVITY * self.mass;
        let before = self.flow_range.looked_us();
        let range = view.and_then(|view| self.flow_range.new_range(view, at_us, flies));
        let ranged = self.flow_range.looked_us();
        let looked = (ranged != before && self.flow_range.range_is_sound()).then_some(ranged);
        if !(inertial.q.is_finite() && inertial.accel.is_finite() && lift.is_finite()) {
            return None;
        }
        let down = inertial.q.rotate(inertial.accel).z + GRAVITY;
        let dt = seconds(core::mem::replace(&mut self.at_us, at_us), at_us);
        self.vertical_speed
            .step(down, flies, scalar::clamp(dt, 0.0, STEP_MAX));
        let vertical = self.vertical_speed.state();
        self.flow_range
            .predict(at_us, flies.then_some(down), inertial.q, &vertical);
        // A wrongly scaled range gives no height; its changes may prove that it is right again.
        let range = match range {
            Some((at, distance)) if self.flow_range.scale.wrong() => {
                if let Some(then) = self.history.at(at) {
                    self.flow_range.watch_scaled(then.q, distance);
                }
                None
            }
            range => range,
        };
        let swing = self.pose_monitor.predict(inertial);
        if let Some(fix) = new {
            let velocity = self
                .track
                .as_ref()
                .filter(|track| track.posed)
                .map(Track::velocity);
            self.pose_monitor
                .update(fix, self.history.at(fix.at_us).as_ref(), flies, velocity);
        }
        let left_out = self.pose_monitor.fault().is_some();
        let new = new.filter(|_| !left_out).map(|fix| Fix {
            variance: Some(self.pose_monitor.variance(fix)),
            ..*fix
        });
        let new = new.as_ref();
        let here = StateSnapshot {
            at_us,
            q: inertial.q,
            swing,
            ..StateSnapshot::default()
        };
        let track = match (&mut self.track, new) {
            (Some(track), _) if track.follows(at_us) => track,
            (track, Some(fix)) => {
                self.history.clear();
                self.baro_height.forget();
                *track = Some(Track::begin(at_us, inertial.q.to_euler().2, fix));
                return None;
            }
            (track, None) => {
                // The axes begin at the first usable flow: on the ground below, with the vehicle's own heading.
                let height = flow.and_then(|flow| self.flow_range.begin(&flow, inertial.q));
                self.learnt = track.as_ref().map_or(self.learnt, Track::learnt);
                *track = height.map(|height| {
                    self.history.clear();
                    self.baro_height.forget();
                    Track::above(at_us, height, self.learnt.as_ref(), &vertical)
                });
                // The track's own position: the interval of the next flow may begin here.
                let position = track.as_ref().map_or(here.position, Track::position);
                self.history.push(StateSnapshot { position, ..here });
                return None;
            }
        };
        track.predict(inertial, (lift / self.mass, self.motor_tau));
        self.history.push(StateSnapshot {
            position: track.position(),
            ..here
        });
        track.left_out |= left_out;
        let reset_count = track.reset_count;
        if self.pose_monitor.fault() == Some(PoseFault::Disagrees) && !track.dead_reckoning_invalid {
            track.invalidate_dead_reckoning();
            // The poses have bent the vertical speed, too.
            let [_, _, axis] = &mut track.axes;
            axis.set_speed(self.vertical_speed.inertial());
            track.dead_reckoning_invalid = true;
            self.baro_height.forget();
        }
        if let Some(fix) = new {
            track.take(&mut self.history, &mut self.pose_monitor, fix);
        }
        if let Some(at) = looked {
            let distance = range.map(|(_, distance)| distance);
            track.step_on(&self.history, self.flow_range.lens, at, distance);
        }
        let posed = track.posed && seconds(track.pose_us, at_us) < POSE_FRESH;
        if let Some((at, distance)) = range {
            let range = (at, distance, vertical);
            track.take_range(&mut self.history, &mut self.flow_range, range, posed);
        }
        if posed {
            let dt = scalar::clamp(dt, 0.0, STEP_MAX);
            self.vertical_speed.follow(track.velocity().z, dt);
        }
        if self.vertical_speed.rests() && !posed {
            track.rest();
        }
        if let Some(flow) = flow {
            track.take_flow(&mut self.history, &mut self.flow_range, &flow, posed);
        }
        let flow_inconsistent = self.flow_range.is_inconsistent() && !posed;
        if flow_inconsistent && !track.flow_inconsistent {
            track.invalidate_dead_reckoning();
        }
        track.flow_inconsistent = flow_inconsistent;
        if track.reset_count != reset_count {
            self.baro_height.forget();
            self.flow_range.forget_surfaces();
        }
        if let Some(at) = self.baro_height.news(at_us)
            && flies
        {
            track.take_pressure(&mut self.history, &mut self.baro_height, at);
        }
        track.estimate(self.baro_height.carries(at_us), self.flow_range.levels())
    }
}

/// State since the first fix.
#[derive(Clone, Debug)]
struct Track {
    /// North or forward, east or right, down.
    axes: [Axis; 3],
    yaw_offset: f32,
    /// Thrust over mass, with the motors' lag, m/s².
    lift: f32,
    disturbance: Vec3,
    /// Times of the last step and of the newest fused fix or flow, µs.
    at_us: u64,
    fixed_us: u64,
    fixes: u32,
    /// Poses were rejected since the last fused one.
    left_out: bool,
    /// Dead reckoning was invalidated because the poses disagree.
    dead_reckoning_invalid: bool,
    /// Dead reckoning was invalidated because flow or range disagree.
    flow_inconsistent: bool,
    /// A pose was fused, the newest one at this time, µs: the axes are its sender's.
    posed: bool,
    pose_us: u64,
    /// Measurement time of the newest pose or range that gave the height, µs.
    height_us: u64,
    /// Flows refused in a row.
    flows_refused: u32,
    resets: u8,
    reset_count: u8,
    ready: bool,
    range_hit: RangeHit,
    /// Measurement time of `surface_point`, µs; 0 before the first.
    range_hit_us: u64,
}

impl Track {
    fn begin(at_us: u64, yaw: f32, fix: &Fix) -> Self {
        let axes = fix.position.to_array().map(Axis::at);
        Self {
            axes,
            yaw_offset: scalar::wrap_pi(fix.heading - yaw),
            lift: 0.0,
            disturbance: Vec3::ZERO,
            at_us,
            fixed_us: fix.at_us,
            fixes: 1,
            left_out: false,
            dead_reckoning_invalid: false,
            flow_inconsistent: false,
            posed: true,
            pose_us: fix.at_us,
            height_us: fix.at_us,
            flows_refused: 0,
            resets: fix.resets,
            reset_count: 0,
            ready: false,
            range_hit: RangeHit::default(),
            range_hit_us: 0,
        }
    }

    /// A track at rest `height` m above the ground, in the vehicle's own axes, with the biases of the track before.
    fn above(at_us: u64, height: f32, before: Option<&(u64, [Axis; 3])>, vertical: &VerticalState) -> Self {
        let here = Fix {
            at_us,
            position: Vec3::new(0.0, 0.0, -height),
            ..Fix::default()
        };
        let mut track = Self {
            posed: false,
            ..Self::begin(at_us, 0.0, &here)
        };
        if let Some((ended_us, before)) = before {
            let since = seconds(*ended_us, at_us);
            let pairs = track.axes.iter_mut().zip(before).zip(KEPT_BIAS);
            for ((axis, before), deviation) in pairs {
                *axis = axis.biased_as(before, deviation, since);
            }
        }
        let [_, _, axis] = &mut track.axes;
        axis.start(&axis.with_own_bias(vertical));
        track
    }

    /// Its end, µs, and its axes, if these are the vehicle's own and the biases are plausible for a sensor.
    fn learnt(&self) -> Option<(u64, [Axis; 3])> {
        let sound = self.axes.iter().all(|axis| axis.bias().abs() < SENSOR_BIAS);
        (sound && !self.posed && !self.flow_inconsistent).then_some((self.at_us, self.axes))
    }

    /// The step at `at_us` µs follows the last one, and the newest fix is not too old.
    fn follows(&self, at_us: u64) -> bool {
        let since = seconds(self.at_us, at_us);
        since > 0.0 && since <= STEP_MAX && seconds(self.fixed_us, at_us) < LOST_AGE
    }

    fn predict(&mut self, a: &Inertial, (lift, motor_tau): (f32, f32)) {
        let dt = seconds(self.at_us, a.at_us);
        self.at_us = a.at_us;
        let force = about_down(a.q.rotate(a.accel), self.yaw_offset);
        let acceleration = force + Vec3::new(0.0, 0.0, GRAVITY);
        // A pose's errors last: what the acceleration says in between weighs less.
        let down = if self.posed { LEANING } else { DOWN };
        let noises = [LEANING, LEANING, down];
        for ((axis, acceleration), noise) in self.axes.iter_mut().zip(acceleration.to_array()).zip(noises) {
            axis.predict(acceleration, noise, dt);
        }
        // Across the thrust axis rotors push little: the acceleration measured there comes from the air, and from the
        // arms' lean.
        let across =
            about_down(a.q.rotate(Vec3::new(a.accel.x, a.accel.y, 0.0)), self.yaw_offset) - self.bias();
        self.lift += (lift - self.lift) * dt / (dt + motor_tau);
        let down = acceleration.z - self.bias().z - GRAVITY + self.lift * a.q.down_in_body().z;
        let follow = |from: f32, to: f32, cutoff: f32| from + (to - from) * cutoff * dt / (1.0 + cutoff * dt);
        let Vec3 { x, y, z } = self.disturbance;
        self.disturbance = Vec3::new(
            follow(x, across.x, LATERAL_CUTOFF),
            follow(y, across.y, LATERAL_CUTOFF),
            follow(z, down, VERTICAL_CUTOFF),
        );
    }

    /// Fuses `fix` by the state at its measurement.
    fn take(&mut self, history: &mut StateHistory, pose_monitor: &mut ExternalPoseMonitor, fix: &Fix) {
        let Some(then) = history.at(fix.at_us) else {
            return;
        };
        let yaw = then.yaw();
        let innovation = fix.position - then.position;
        let variance = fix.variance();
        let close = |((axis, y), r): ((&Axis, f32), f32)| axis.accepts(y, r);
        let pairs = self.axes.iter().zip(innovation.to_array());
        let accepted = pairs.zip(variance.to_array()).all(close);
        let off = scalar::wrap_pi(fix.heading - yaw - self.yaw_offset);
        let unknown = self.left_out || seconds(self.pose_us, fix.at_us) > UNKNOWN_AGE;
        let elsewhere = !accepted || off.abs() > TURN_STEP;
        if !self.posed || fix.resets != self.resets || (unknown && elsewhere) {
            if pose_monitor.is_outlier(fix) {
                return;
            }
            history.clear();
            self.jump(yaw, fix);
        } else if accepted {
            pose_monitor.note_gate(fix.at_us, false);
            let lag = seconds(fix.at_us, self.at_us);
            let mut changes = [Change::default(); 3];
            let inputs = innovation.to_array().into_iter().zip(variance.to_array());
            for ((axis, change), (y, r)) in self.axes.iter_mut().zip(&mut changes).zip(inputs) {
                *change = axis.correct(y, r, lag);
            }
            history.change(fix.at_us, &changes);
            let gain = scalar::clamp(1.0 / (1.0 + self.fixes as f32), TURN_GAIN, 1.0);
            self.yaw_offset = scalar::wrap_pi(self.yaw_offset + gain * scalar::clamp_abs(off, TURN_STEP));
            self.count();
        } else {
            pose_monitor.note_gate(fix.at_us, true);
            return;
        }
        (self.left_out, self.dead_reckoning_invalid) = (false, false);
        self.fixed_us = fix.at_us;
        (self.posed, self.pose_us, self.height_us) = (true, fix.at_us, fix.at_us);
    }

    /// Invalidates dead reckoning after poses or flow have disagreed with the vehicle's motion: the velocity gets the
    /// variance of a first fix, the horizontal biases are reset, so that the disturbance is the acceleration as measured,
    /// and the age rises to [`DEAD_RECKONING_INVALID_AGE`], so that no mode coasts.
    fn invalidate_dead_reckoning(&mut self) {
        self.fixed_us = self
            .fixed_us
            .min(self.at_us.saturating_sub(DEAD_RECKONING_INVALID_AGE));
        for axis in &mut self.axes {
            axis.set_speed(axis.velocity());
        }
        let [x, y, _] = &mut self.axes;
        for axis in [x, y] {
            axis.forget_bias();
        }
    }

    /// Counts a fused fix or flow.
    fn count(&mut self) {
        self.fixes = self.fixes.saturating_add(1);
        let known = self.axes.iter().all(|axis| axis.speed_within(READY_SPEED));
        self.ready |= known && self.fixes >= READY_FIXES;
    }

    /// Stores the hit of a range of `distance` m, measured at `at` µs.
    fn step_on(&mut self, history: &StateHistory, lens: Vec3, at: u64, distance: Option<f32>) {
        let Some(then) = history.at(at).map(|moment| moment.of(lens, self.yaw_offset)) else {
            return;
        };
        self.range_hit.surface_point = distance.map(|d| then.position + beam(then.q, d, self.yaw_offset));
        (self.range_hit.lens, self.range_hit.beam) = (then.position, beam(then.q, 1.0, self.yaw_offset));
        self.range_hit.count = self.range_hit.count.wrapping_add(1);
        self.range_hit_us = at;
    }

    /// Fuses a range of `distance` m, measured at `at` µs, as height; beside a pose it gives the height of the ground
    /// alone.
    fn take_range(
        &mut self,
        history: &mut StateHistory,
        flow_range: &mut FlowRangeFusion,
        (at, distance, anew): (u64, f32, VerticalState),
        posed: bool,
    ) {
        if distance < STANDING && !posed {
            // Flow is blind so near, and the surface carries the vehicle or soon will: the vehicle's horizontal speed is
            // fused as zero.
            let lag = seconds(at, self.at_us);
            let [x, y, _] = &mut self.axes;
            let [along, across] = [x, y].map(|axis| axis.correct_speed(-axis.velocity(), STAND_SPEED, lag));
            history.change(at, &[along, across, Change::default()]);
        }
        let frame = Frame {
            at_us: self.at_us,
            yaw_offset: self.yaw_offset,
            posed,
            anew,
        };
        let [_, _, axis] = &mut self.axes;
        let counted = flow_range.take_height(axis, history, (at, distance), &frame);
        self.height_us = counted.map_or(self.height_us, |at| self.height_us.max(at));
    }

    /// Something carries the vehicle: it does not move down.
    fn rest(&mut self) {
        let [_, _, axis] = &mut self.axes;
        axis.correct_speed(-axis.velocity(), REST_SPEED, 0.0);
        self.height_us = self.at_us;
    }

    /// Fuses the newest pressure, measured at `at` µs, as height; beside range or pose only its offset is learnt.
    fn take_pressure(&mut self, history: &mut StateHistory, baro_height: &mut BaroHeight, at: u64) {
        let Some(then) = history.at(at) else {
            return;
        };
        let known = seconds(self.height_us, at);
        let Some((innovation, variance)) = baro_height.height(then.position.z, known) else {
            return;
        };
        let [_, _, axis] = &mut self.axes;
        if axis.accepts(innovation, variance) {
            let change = axis.correct(innovation, variance, seconds(at, self.at_us));
            history.change(at, &[Change::default(), Change::default(), change]);
        } else {
            baro_height.refuse();
        }
    }

    /// Fuses a flow by the velocity in the middle of its interval; beside a pose it is only monitored.
    fn take_flow(
        &mut self,
        history: &mut StateHistory,
        flow_range: &mut FlowRangeFusion,
        flow: &Flow,
        posed: bool,
    ) {
        let begin = flow.until_us.saturating_sub((flow.seconds * 1e6) as u64);
        let middle = begin + flow.until_us.saturating_sub(begin) / 2;
        let (Some(from), Some(to)) = (history.at(begin), history.at(flow.until_us)) else {
            return;
        };
        // Between the lens' two places lies the vehicle's way, and what its turning adds.
        let [from, to] = [from, to].map(|moment| moment.of(flow_range.lens, self.yaw_offset));
        let Some(seen) = flow_range.velocity(flow, &from, &to, self.yaw_offset) else {
            return;
        };
        if posed {
            return;
        }
        let [x, y, _] = &mut self.axes;
        let sides = [(x, seen.off[0]), (y, seen.off[1])];
        if sides
            .iter()
            .any(|(axis, off)| !axis.accepts_speed(*off, seen.variance))
        {
            self.flows_refused += 1;
            if self.flows_refused < FLOWS_REFUSED_MAX {
                return;
            }
            for (axis, off) in sides {
                axis.set_speed(axis.velocity() + off);
            }
        } else {
            let lag = seconds(middle, self.at_us);
            let [along, across] = sides.map(|(axis, off)| axis.correct_speed(off, seen.variance, lag));
            history.change(middle, &[along, across, Change::default()]);
            self.count();
        }
        self.flows_refused = 0;
        self.fixed_us = flow.until_us;
    }

    /// Moves the track to the sender's new origin; velocity and bias stay, rotated by the change of the yaw offset.
    fn jump(&mut self, yaw: f32, fix: &Fix) {
        let before = self.yaw_offset;
        self.yaw_offset = scalar::wrap_pi(fix.heading - yaw);
        let by = self.yaw_offset - before;
        let velocity = about_down(self.velocity(), by);
        let bias = about_down(self.bias(), by);
        self.disturbance = about_down(self.disturbance, by);
        let values = velocity.to_array().into_iter().zip(bias.to_array());
        for ((axis, position), (velocity, bias)) in
            self.axes.iter_mut().zip(fix.position.to_array()).zip(values)
        {
            axis.jump(position, velocity, bias);
        }
        self.resets = fix.resets;
        self.reset_count = self.reset_count.wrapping_add(1);
    }

    fn of(&self, value: impl Fn(&Axis) -> f32) -> Vec3 {
        let [x, y, z] = &self.axes;
        Vec3::new(value(x), value(y), value(z))
    }

    fn position(&self) -> Vec3 {
        self.of(Axis::position)
    }

    fn velocity(&self) -> Vec3 {
        self.of(Axis::velocity)
    }

    fn bias(&self) -> Vec3 {
        self.of(Axis::bias)
    }

    fn estimate(&self, by_pressure: bool, levels: SurfaceLevels) -> Option<Estimate> {
        let height_age = seconds(self.height_us, self.at_us);
        // Without a height the position is invalid.
        let lost = height_age > HEIGHT_AGE && !by_pressure;
        let age = seconds(self.fixed_us, self.at_us).max(if lost { height_age } else { 0.0 });
        let estimate = Estimate {
            position: self.position(),
            velocity: self.velocity(),
            disturbance: self.disturbance,
            yaw_offset: self.yaw_offset,
            age,
            height_age,
            levels,
            by_pressure,
            reset_count: self.reset_count,
            range_hit: match self.range_hit_us {
                0 => RangeHit::default(),
                at => RangeHit {
                    age: seconds(at, self.at_us),
                    ..self.range_hit
                },
            },
        };
        (self.ready && estimate.is_finite()).then_some(estimate)
    }
}
