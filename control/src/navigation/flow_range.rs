//! Fusion of optical flow and range: velocity over the ground, height above it, and the faults of both.

mod range_height;
#[cfg(test)]
mod tests;

pub use range_height::Frame;

use super::consistency::Agreement;
use super::estimate::SurfaceLevels;
use super::frozen_range::Frozen;
use super::history::StateSnapshot;
use super::pipe_footprint::{Depth, PipeFootprint};
use super::range_scale::{Below, RangeScale};
use super::settled_hits::SettledHits;
use super::surface_step::SurfaceStep;
use super::texture::Texture;
use super::vertical_speed::VerticalState;
use crate::maths::elapsed::seconds;
use crate::maths::frames::about_down;
use crate::maths::scalar;
use crate::maths::vector::{Quat, Vec3};
use crate::navigation::flow_range_sample::{Flow, GroundView, Range};

/// Heights between which flow is used, m: nearer its lens sees no picture (PMW3901). Up to 2.4 m a scale 10 % too
/// large, five times the error that calibration leaves, does not make the hold swing; one 20 % too large does from 1 m
/// on (docs/lab/2026-11-24-position-hold.md).
pub const FLOW_HEIGHT: (f32, f32) = (0.08, 2.5);
/// Least quality of a flow, of 255.
const QUALITY_MIN: u8 = 20;
/// Deviation of a flow, rad: 0.12 rad/s in 20 ms (assumed for modules of this class).
const FLOW_NOISE: f32 = 2.4e-3;
/// Apparent over true distance of the ground for a view of 42° whose scale was calibrated by rotation: a ray at the
/// angle α moves by 1 + tan² α in a rotation and by 1 in a translation, in the mean 1 + tan²(21°) / 3.
const CALIBRATED: f32 = 1.049;
/// Relative error of a velocity by flow and range, 1.
const SCALE_NOISE: f32 = 0.05;
/// Age beyond which a range is not the present height, µs.
const RANGE_AGE: u64 = 300_000;
/// Equal flows in a row, none of them zero, that make the sensor frozen.
const FROZEN_FLOWS: u32 = 12;
/// Least cosine of the tilt at which flow and range are used: 40°.
const COS_MIN: f32 = 0.77;
/// Range below which flow is not judged, m: there the noise of the estimated velocity is as large as a slow turn.
const JUDGED: f32 = 0.45;
/// Relative uncertainty of the scene's distance by its textures up to which flow is judged: half a scale that is borne.
const KNOWN_MIX: f32 = 0.15;
/// Time after a range step for which flow is not judged, µs: three time constants of the high-pass in `Agreement`.
const UNSURE_TIME: u64 = 600_000;

/// Fault of flow or range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowRangeFault {
    /// The flow repeats whatever the motion of the vehicle.
    FlowFrozen,
    /// The flow disagrees with the vehicle's own motion: mirrored, turned, dead or of another scale.
    FlowDisagrees,
    /// The range repeats whatever the motion of the vehicle.
    RangeFrozen,
    /// The range steps more often than ground does.
    RangeJumps,
    /// The range changes by more or less than the vehicle rises or sinks.
    RangeScaled,
    /// No range has fitted the height by the inertial sensor for a long time.
    RangeInconsistent,
}

impl FlowRangeFault {
    /// Every fault.
    pub const ALL: [Self; 6] = [
        Self::FlowFrozen,
        Self::FlowDisagrees,
        Self::RangeFrozen,
        Self::RangeJumps,
        Self::RangeScaled,
        Self::RangeInconsistent,
    ];

    /// For the pilot's display: at most 40 ASCII characters.
    pub const fn text(self) -> &'static str {
        match self {
            Self::FlowFrozen => "flow frozen, left out",
            Self::FlowDisagrees => "flow mirrored or scaled, left out",
            Self::RangeFrozen => "range frozen, left out",
            Self::RangeJumps => "range jumps, left out",
            Self::RangeScaled => "range scaled, left out",
            Self::RangeInconsistent => "range inconsistent, left out",
        }
    }
}

/// Why flow cannot be used where the vehicle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlowRangeLimit {
    /// Its lens sees no picture so near.
    TooLow,
    /// The error of its scale would swing the hold.
    TooHigh,
    /// No target within the range's reach.
    NoRange,
    /// The quality of the picture is too low.
    TooDark,
}

impl FlowRangeLimit {
    /// Every limit.
    pub const ALL: [Self; 4] = [Self::TooLow, Self::TooHigh, Self::NoRange, Self::TooDark];

    /// The limit of the newest flow and range; `None` if both can be used.
    pub fn of(view: &GroundView) -> Option<Self> {
        let (least, most) = FLOW_HEIGHT;
        match view.range.and_then(|range| range.checked()?.distance) {
            None => Some(Self::NoRange),
            Some(distance) if distance < least => Some(Self::TooLow),
            Some(distance) if distance > most => Some(Self::TooHigh),
            Some(_) if view.flow.is_none_or(|flow| flow.quality < QUALITY_MIN) => Some(Self::TooDark),
            Some(_) => None,
        }
    }

    /// For the pilot's display: at most 40 ASCII characters.
    pub const fn text(self) -> &'static str {
        match self {
            Self::TooLow => "too low for flow",
            Self::TooHigh => "too high for flow: 2.5 m",
            Self::NoRange => "no range: too high, or over an edge",
            Self::TooDark => "flow sees no picture",
        }
    }
}

/// Innovation of a velocity over the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Measured less estimated, along the estimate's axes, m/s.
    pub off: [f32; 2],
    /// Its variance, (m/s)².
    pub variance: f32,
}

/// State of the ground model and of the module's monitors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowRangeFusion {
    /// Half the diameter of the pipe, m.
    radius: f32,
    /// Lens from the centre of mass, m, body: the lever arm of both sensors.
    pub(crate) lens: Vec3,
    /// Newest range with a distance: time, µs, and distance, m.
    range: Option<(u64, f32)>,
    /// Measurement time of the newest range processed, and the time of processing, µs.
    range_us: u64,
    now_us: u64,
    /// Monitor of its scale.
    pub(crate) scale: RangeScale,
    /// The surfaces were measured by a range that proved to be wrong, or in other axes: they begin at the next range.
    anew: bool,
    /// First hit on a surface acquired without a predecessor (after lift-off). It may be the pipe, so its range noise
    /// is inflated until the beam has moved 1.6 diameters on it or dropped one diameter off it; `None` from then on.
    unproven: Option<Vec3>,
    /// Levels of the surfaces, m: the raised one is that of the estimate's axis.
    levels: SurfaceLevels,
    /// The beam is on the raised one; time, µs, and place of the first hit on it.
    raised: bool,
    entered: (u64, Vec3),
    /// A step that has begun, and the ranges that wait on the present surface.
    step: SurfaceStep,
    settled: SettledHits,
    /// Surface onto which the beam has come, until the scale's monitor knows of it.
    arrived: Option<Below>,
    /// Since when ranges have been refused, µs; `None` while they are not.
    refused_us: Option<u64>,
    /// End of the time for which a range that fits no height is left out, µs, and that the height is lost by it.
    inconsistent_us: u64,
    lost: bool,
    /// Newest range that was compared with the surfaces, µs.
    hit_us: u64,
    /// Newest flow that was used, µs.
    flow_us: u64,
    /// Excess of steps over [`STEPS_RATE`], time of the last step, and end of the range's rejection, µs.
    steps: f32,
    stepped_us: u64,
    distrusted_us: u64,
    /// Last hit on the present surface, and place of the edge of a step.
    surface_point: Vec3,
    stepped_at: Vec3,
    /// Band of the narrow object, if one is known; time, µs, and place of its last hit.
    pub(crate) band: Option<PipeFootprint>,
    met: (u64, Vec3),
    pub(crate) frozen: Frozen,
    same_flows: u32,
    angle: [f32; 2],
    agreements: [Agreement; 2],
    /// Which of pipe and ground the flow follows while it sees both.
    texture: Texture,
    /// Last time at which the depth was uncertain, µs.
    unsure_us: u64,
    disagrees: bool,
}

impl FlowRangeFusion {
    /// A fusion over pipes of `diameter` m, with the `lens` at this place from the centre of mass, m, body.
    pub fn new(diameter: f32, lens: Vec3) -> Self {
        Self {
            radius: 0.5 * diameter,
            lens,
            ..Self::default()
        }
    }

    /// Levels of the surfaces below.
    pub fn levels(&self) -> SurfaceLevels {
        self.levels
    }

    /// The present fault.
    pub fn fault(&self) -> Option<FlowRangeFault> {
        let faults = [
            (self.frozen.holds(), FlowRangeFault::RangeFrozen),
            (self.distrusted_us > self.range_us, FlowRangeFault::RangeJumps),
            (self.scale.wrong(), FlowRangeFault::RangeScaled),
            (
                self.inconsistent_us > self.range_us,
                FlowRangeFault::RangeInconsistent,
            ),
            (self.same_flows >= FROZEN_FLOWS, FlowRangeFault::FlowFrozen),
            (self.disagrees, FlowRangeFault::FlowDisagrees),
        ];
        faults.iter().find(|(holds, _)| *holds).map(|(_, fault)| *fault)
    }

    /// Flow or range disagree with the vehicle's motion, so that the estimate by them is invalid.
    pub fn is_inconsistent(&self) -> bool {
        self.disagrees || self.scale.wrong()
    }

    /// Measurement time of the newest range processed, µs.
    pub fn looked_us(&self) -> u64 {
        self.range_us
    }

    /// The range is free of faults.
    pub fn range_is_sound(&self) -> bool {
        !self.range_faulty()
    }

    fn range_faulty(&self) -> bool {
        let left_out = self.distrusted_us.max(self.inconsistent_us) > self.range_us;
        self.frozen.holds() || left_out || self.scale.wrong()
    }

    /// Measurement time, µs, and distance, m, of a range that is not processed yet; `None` without one. A scaled range
    /// is returned too; a frozen or jumping one is not, unless it is also scaled. The rotors carry a vehicle that
    /// `flies`.
    pub fn new_range(&mut self, view: &GroundView, now: u64, flies: bool) -> Option<(u64, f32)> {
        let range = view.range.and_then(Range::checked)?;
        if range.at_us <= self.range_us || range.at_us > now {
            return None;
        }
        (self.range_us, self.now_us) = (range.at_us, now);
        let distance = range.distance?;
        self.frozen.take(distance, range.at_us, flies);
        self.range = Some((range.at_us, distance));
        let used = self.scale.wrong() || !self.range_faulty();
        used.then_some((range.at_us, distance))
    }

    /// Takes the measured acceleration `down`, m/s², gravity removed, at `at_us` µs; `None` while the vehicle does not
    /// fly. The tilt of the beam is computed only if a run of equal ranges needs it.
    pub fn predict(&mut self, at_us: u64, down: Option<f32>, q: Quat, stood: &VerticalState) {
        self.scale.predict(at_us, down, stood);
        if self.frozen.needs_motion() {
            let leans = (q.down_in_body().z, q.rotate(self.lens).z);
            self.frozen.predict(at_us, down, leans, self.scale.climb());
        }
    }

    /// Monitors a range of `distance` m, measured with the attitude `q`, that is rejected as scaled.
    pub fn watch_scaled(&mut self, q: Quat, distance: f32) {
        self.anew = true;
        let cos = q.down_in_body().z;
        if cos >= COS_MIN {
            self.update_scale(distance * cos, q, Below::Plain);
        }
    }

    /// Compares the vertical part of the newest range, `height` m, with the inertial motion.
    fn update_scale(&mut self, height: f32, q: Quat, below: Below) {
        let lag = seconds(self.range_us, self.now_us);
        // Height of the centre of mass, without the lever arm: its swing is no motion of the vehicle, and its error
        // does not pass for a scale.
        self.scale.update(height + q.rotate(self.lens).z, lag, below);
    }

    /// Height of the centre of mass above the ground with which an estimate may begin, m, at a flow with the attitude
    /// `q`; `None` if flow or range cannot be used.
    pub fn begin(&mut self, flow: &Flow, q: Quat) -> Option<f32> {
        let cos = q.down_in_body().z;
        let (at, distance) = self.range.filter(|_| !self.range_faulty())?;
        let (least, most) = FLOW_HEIGHT;
        let fresh = flow.until_us.saturating_sub(at) <= RANGE_AGE;
        let sound = cos >= COS_MIN && flow.quality >= QUALITY_MIN && (least..=most).contains(&distance);
        // Steps and places of the axes before are dropped: a surface that is not known to be wide is at the present hit.
        self.forget_surfaces();
        (self.levels, self.anew) = (SurfaceLevels::default(), false);
        let height = distance * cos + q.rotate(self.lens).z;
        let below = Vec3::new(0.0, 0.0, -height) + q.rotate(self.lens) + beam(q, distance, 0.0);
        self.surface_point = below;
        self.unproven = self.unproven.map(|_| below);
        self.agreements = self.agreements.map(Agreement::anew);
        (fresh && sound).then_some(height)
    }

    /// Effective distance of the flow's scene from `to`. Beside a narrow object the rest of the view is farther; if an
    /// edge of the object was seen, its share of the view is known.
    pub(crate) fn depth(&self, to: &StateSnapshot, cos: f32, yaw_offset: f32) -> Depth {
        let far = |surface_z: f32| {
            let (least, most) = FLOW_HEIGHT;
            scalar::clamp((surface_z - to.position.z) / cos, least, 2.0 * most)
        };
        let near = far(self.present_level());
        let surface_point = to.position + beam(to.q, near, yaw_offset);
        let seen = match self.band {
            Some(band) => band.depth(
                to.position,
                surface_point,
                far(self.levels.ground),
                self.texture.weight(),
            ),
            None => Depth {
                distance: near,
                by_weight: 0.0,
                doubt: 0.0,
                lean: Vec3::ZERO,
            },
        };
        Depth {
            distance: CALIBRATED * seen.distance,
            by_weight: seen.by_weight / CALIBRATED,
            ..seen
        }
    }

    /// Innovation of the velocity of the lens between `from` and `to` by `flow`, in axes turned by `yaw_offset` rad;
    /// `None` if the flow cannot be used.
    pub fn velocity(
        &mut self,
        flow: &Flow,
        from: &StateSnapshot,
        to: &StateSnapshot,
        yaw_offset: f32,
    ) -> Option<Seen> {
        self.watch_frozen(flow);
        let cos = to.q.down_in_body().z;
        let (at, distance) = self.range.filter(|_| !self.range_faulty())?;
        let (least, most) = FLOW_HEIGHT;
        let fresh = flow.until_us.abs_diff(at) <= RANGE_AGE;
        // Over an edge that is not known yet the scene is as far as either surface.
        let unknown = self.step.begun() && self.band.is_none();
        let dark = cos < COS_MIN || flow.quality < QUALITY_MIN;
        if !fresh || dark || unknown || !(least..=most).contains(&distance) {
            return None;
        }
        let Depth {
            distance: depth,
            by_weight,
            doubt,
            lean,
        } = self.depth(to, cos, yaw_offset);
        // Rotation of the vehicle, body.
        let turned = from.q.conjugate() * to.q;
        let half = if turned.w < 0.0 { -2.0 } else { 2.0 };
        let turned = [half * turned.x, half * turned.y];
        let displacement = about_down(to.position - from.position, -yaw_offset);
        let displacement = to.q.rotate_inverse(displacement);
        // In a descent, near objects on one side of the view seem to move to that side.
        let aside = to.q.rotate_inverse(about_down(lean, -yaw_offset)) * displacement.z;
        let [roll, pitch] = flow.angle;
        let angle = [roll - aside.y / depth, pitch + aside.x / depth];
        let [roll, pitch] = angle;
        let predicted = [
            turned[0] - displacement.y / depth,
            turned[1] + displacement.x / depth,
        ];
        let per = 1.0 / flow.seconds;
        let pairs = self.agreements.iter_mut().zip(angle).zip(predicted);
        if self.step.begun() || distance < JUDGED {
            self.unsure_us = flow.until_us;
        }
        // Relative uncertainty by the textures: before it is known which of them the flow follows, no scale is judged.
        let mixed = (by_weight * depth).abs() * self.texture.deviation();
        let sure = flow.until_us.saturating_sub(self.unsure_us) > UNSURE_TIME && mixed < KNOWN_MIX;
        self.texture.update(
            [roll - predicted[0], pitch - predicted[1]],
            [-displacement.y * by_weight, displacement.x * by_weight],
            FLOW_NOISE,
            flow.seconds,
        );
        let mut disagrees = false;
        for ((agreement, measured), predicted) in pairs {
            let (measured, predicted) = (measured * per, predicted * per);
            disagrees |= agreement.step(measured, predicted, FLOW_NOISE * per, sure, flow.seconds);
        }
        self.disagrees = disagrees;
        if disagrees || self.same_flows >= FROZEN_FLOWS {
            return None;
        }
        // Flow does not observe the body's down axis: the estimate is used there.
        let seen = Vec3::new(
            (pitch - turned[1]) * depth,
            (turned[0] - roll) * depth,
            displacement.z,
        );
        let off = about_down(to.q.rotate(seen - displacement), yaw_offset) * per;
        self.flow_us = flow.until_us;
        let speed = FLOW_NOISE * depth * per;
        let scale = (SCALE_NOISE + doubt + mixed) * (seen.x.abs() + seen.y.abs()) * per;
        Some(Seen {
            off: [off.x, off.y],
            variance: speed * speed + scale * scale,
        })
    }

    fn watch_frozen(&mut self, flow: &Flow) {
        let moves = flow.angle.iter().any(|angle| angle.abs() > 1e-6);
        let same = self
            .angle
            .iter()
            .zip(flow.angle)
            .all(|(a, b)| (a - b).abs() < 1e-7);
        self.same_flows = if same && moves {
            self.same_flows.saturating_add(1)
        } else {
            0
        };
        self.angle = flow.angle;
    }
}

/// Vector from the lens of a vehicle with the attitude `q` to the target of its range, `distance` m away, in axes
/// turned by `yaw_offset` rad.
pub fn beam(q: Quat, distance: f32, yaw_offset: f32) -> Vec3 {
    about_down(q.rotate(Vec3::new(0.0, 0.0, distance)), yaw_offset)
}
