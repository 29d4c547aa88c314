//! Fusion of optical flow and range: velocity over the ground, height above it, and the faults of both.

use super::consistency::Agreement;
use super::frozen_range::Frozen;
use super::history::StateSnapshot;
use super::pipe_footprint::{Depth, PipeFootprint};
use super::range_scale::{Below, RangeScale};
use super::surface_step::{BEAM, SurfaceStep};
use super::texture::Texture;
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
/// Deviation of a range, m.
const RANGE_NOISE: f32 = 0.02;
/// Age beyond which a range is not the present height, µs.
const RANGE_AGE: u64 = 300_000;
/// Deviations from the height beyond which a range beside an edge is a mixture of both surfaces; over the ground one that is too
/// near, which a mixture always is.
const GATE: f32 = 3.0;
const NEAR_GATE: f32 = 1.5;
/// Mixtures in a row, half a second at 50 Hz: an edge of 6 cm passes at 0.12 m/s.
const MIXTURES: u32 = 25;
/// Ranges for which the error of a place on the pipe's back stays: half a second at 50 Hz.
const LASTING: f32 = 25.0;
/// Departure of a range from the height that is a step of the surface, m.
const STEP: f32 = 0.12;
/// Ranges that differ by less belong to the same surface, m.
const SAME: f32 = 0.08;
/// Share by which the height of a narrow object follows each range while its flank alone was seen.
const FLANK_SHARE: f32 = 0.2;
/// Ranges for which it follows, half a second at 50 Hz: while height and surface both follow, neither is observed.
const FLANK_RANGES: u32 = 25;
/// Steps a second that are tolerated, and the excess that is a fault: the beam of a vehicle that swings in gusts
/// beside the edge of a pipe crosses it 11 times in 4.3 s, a range that jumps each 0.3 s does so 12 times in 3.3 s.
const STEPS_RATE: f32 = 2.0;
const STEPS_MAX: f32 = 5.0;
/// Time for which the range is rejected then, µs.
const DISTRUST: u64 = 5_000_000;
/// Equal flows in a row, none of them zero, that make the sensor frozen.
const FROZEN_FLOWS: u32 = 12;
/// Least cosine of the tilt at which flow and range are used: 40°.
const COS_MIN: f32 = 0.77;
/// Distance, m, and time, µs, from the last hit of a narrow object after which its band is dropped: a pipe has ends.
const LEFT_BEHIND: (f32, u64) = (2.0, 20_000_000);
/// Offset from the first hit on a surface beyond which that surface is a floor, in pipe diameters.
const WIDE: f32 = 1.2;
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
}

impl FlowRangeFault {
    /// Every fault.
    pub const ALL: [Self; 5] = [
        Self::FlowFrozen,
        Self::FlowDisagrees,
        Self::RangeFrozen,
        Self::RangeJumps,
        Self::RangeScaled,
    ];

    /// For the pilot's display: at most 40 ASCII characters.
    pub const fn text(self) -> &'static str {
        match self {
            Self::FlowFrozen => "flow frozen, left out",
            Self::FlowDisagrees => "flow mirrored or scaled, left out",
            Self::RangeFrozen => "range frozen, left out",
            Self::RangeJumps => "range jumps, left out",
            Self::RangeScaled => "range scaled, left out",
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
    /// The surfaces were measured by a range that proved to be scaled.
    mistaken: bool,
    /// First hit on a surface acquired without a predecessor (after lift-off). It may be the pipe, so its range noise
    /// is inflated until the beam has moved 1.2 diameters on it or dropped one diameter off it; `None` from then on.
    unproven: Option<Vec3>,
    /// Height of the present surface, of the lowest known one and of the other known one, along the estimate's down
    /// axis, m.
    surface_z: f32,
    base: f32,
    other: f32,
    /// A step that has begun, and mixtures of two surfaces in a row.
    step: SurfaceStep,
    mixtures: u32,
    /// Excess of steps over [`STEPS_RATE`], time of the last step, and end of the range's rejection, µs.
    steps: f32,
    stepped_us: u64,
    distrusted_us: u64,
    /// Last hit on the present surface, and place of the edge of a step.
    surface_point: Vec3,
    stepped_at: Vec3,
    /// Ranges left for which the height of a narrow object is learnt: its flank was seen alone.
    flank: u32,
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

    /// The present fault.
    pub fn fault(&self) -> Option<FlowRangeFault> {
        let faults = [
            (self.frozen.holds(), FlowRangeFault::RangeFrozen),
            (self.distrusted_us > self.range_us, FlowRangeFault::RangeJumps),
            (self.scale.wrong(), FlowRangeFault::RangeScaled),
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
        self.frozen.holds() || self.distrusted_us > self.range_us || self.scale.wrong()
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
    pub fn predict(&mut self, at_us: u64, down: Option<f32>, q: Quat) {
        self.scale.predict(at_us, down);
        if self.frozen.needs_motion() {
            let leans = (q.down_in_body().z, q.rotate(self.lens).z);
            self.frozen.predict(at_us, down, leans, self.scale.climb());
        }
    }

    /// Monitors a range of `distance` m, measured with the attitude `q`, that is rejected as scaled.
    pub fn watch_scaled(&mut self, q: Quat, distance: f32) {
        self.mistaken = true;
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
        (self.surface_z, self.base, self.other) = (0.0, 0.0, 0.0);
        // Steps, flank and places of the axes before are dropped: a surface that is not known to be wide is at the
        // present hit.
        (self.step, self.flank) = (SurfaceStep::default(), 0);
        self.band = None;
        let height = distance * cos + q.rotate(self.lens).z;
        let below = Vec3::new(0.0, 0.0, -height) + q.rotate(self.lens) + beam(q, distance, 0.0);
        self.surface_point = below;
        self.unproven = self.unproven.map(|_| below);
        self.agreements = self.agreements.map(Agreement::anew);
        (fresh && sound).then_some(height)
    }

    /// Innovation of the height of the lens at `then`, known to this variance, m², by a range of `distance`, m, with its
    /// variance, m²; `None` while the surface is ambiguous. Beside a fresh pose (`posed`) the surface follows the height
    /// instead. `earlier` gives the motion of the beam; the axes are turned by `yaw_offset`, rad.
    pub fn height(
        &mut self,
        (earlier, then): (&StateSnapshot, &StateSnapshot),
        distance: f32,
        (known_to, posed): (f32, bool),
        yaw_offset: f32,
    ) -> Option<(f32, f32)> {
        let cos = then.q.down_in_body().z;
        if cos < COS_MIN {
            return None;
        }
        let surface = then.position.z + distance * cos;
        // Surfaces measured by a scaled range are dropped: over a ground that it had put too deep the true one would
        // seem raised.
        let anew = core::mem::take(&mut self.mistaken);
        if anew {
            // Verdicts on the flow by that depth are dropped too.
            (self.agreements, self.unsure_us) = (Default::default(), then.at_us);
        }
        if posed || anew {
            (self.surface_z, self.base, self.other) = (surface, surface, surface);
            self.band = None;
            return None;
        }
        let surface_point = then.position + beam(then.q, distance, yaw_offset);
        // Innovation of a hit on the present surface.
        let off = self.surface_z - surface;
        let raised = self.raised();
        let heading = then.yaw() + yaw_offset;
        let below = PipeFootprint::below(surface_point, heading, self.radius, self.surface_z);
        if !self.scale.begun() {
            self.unproven = Some(surface_point);
        }
        let wide = WIDE * 2.0 * self.radius;
        self.unproven = self.unproven.filter(|first| below.aside(*first).abs() <= wide);
        if raised {
            self.met = (then.at_us, surface_point);
        } else {
            let (met_us, met) = self.met;
            let (displacement, time) = (surface_point - met, then.at_us.saturating_sub(met_us));
            let moved = Vec3::new(displacement.x, displacement.y, 0.0).norm();
            let behind = moved > LEFT_BEHIND.0 || time > LEFT_BEHIND.1;
            self.band = self.band.filter(|_| !behind);
        }
        let flank = raised && off < 0.0 && below.is_flank(-off);
        if off.abs() <= STEP || flank {
            (self.step, self.surface_point) = (SurfaceStep::default(), surface_point);
            // Point at which the beam passes the band's height: the ground is met farther off.
            let at = |top: f32| then.position + beam(then.q, (top - then.position.z) / cos, yaw_offset);
            self.band = self.band.map(|band| band.bounded(at(band.top), raised));
            self.band = self.band.filter(|band| raised || !band.is_mistaken());
            let noise = RANGE_NOISE * RANGE_NOISE;
            // Beside an edge the beam may see a part of the other surface.
            if !raised {
                // Ground that is too near is in part the pipe.
                let gate = if off > 0.0 { NEAR_GATE } else { GATE };
                let mixture = self.band.is_some() && self.is_mixture(off, gate, known_to + noise);
                let below = if self.unproven.is_some() {
                    Below::Narrow
                } else {
                    Below::Plain
                };
                // The monitor of the scale takes mixtures too: a wrong scale looks like them.
                self.update_scale(distance * cos, then.q, below);
                return (!mixture).then_some((off, noise));
            }
            let band = self.band.get_or_insert(below);
            band.top = self.surface_z;
            let (drop, doubt) = band.drop(surface_point, 0.5 * BEAM * distance);
            let back = surface - drop;
            let variance = noise + LASTING * doubt * doubt;
            let likely = known_to + noise + doubt * doubt;
            if self.flank == 0 && self.is_mixture(self.surface_z - back, GATE, likely) {
                self.update_scale(distance * cos - drop, then.q, Below::Narrow);
                return None;
            }
            let below = if self.flank > 0 {
                Below::Known
            } else {
                Below::Narrow
            };
            if self.flank > 0 {
                self.surface_z += FLANK_SHARE * (back - self.surface_z);
                self.other = self.surface_z;
                self.flank = if doubt > RANGE_NOISE { self.flank - 1 } else { 0 };
            }
            let off = self.surface_z - back;
            self.update_scale(distance * cos - drop, then.q, below);
            return Some((off, variance));
        }
        let near = (distance * cos).min(self.surface_z - then.position.z);
        let known = [self.base, self.other]
            .into_iter()
            .any(|z| (z - surface).abs() <= SAME);
        let across = self.band.unwrap_or(below).across(surface_point);
        // What is deeper than the ground is no mixture with it.
        let deeper = surface - self.base > STEP;
        let over = self.step.take(surface, across, near, known || deeper);
        if self.step.departs() {
            // The edge is at the higher surface's hit: a tilted beam meets the ground a hand's breadth beside the
            // edge.
            self.stepped_at = if off > 0.0 {
                surface_point
            } else {
                self.surface_point
            };
        }
        if over {
            let (before, onto) = (self.surface_z, off > 0.0);
            let within = STEP.max(GATE * scalar::sqrt(known_to + RANGE_NOISE * RANGE_NOISE));
            if off.abs() <= within {
                // No other surface: the height is off.
                self.step = SurfaceStep::default();
                self.update_scale(distance * cos, then.q, Below::Narrow);
                return Some((off, RANGE_NOISE * RANGE_NOISE));
            }
            let known = self.change_surface(surface, within, then.at_us);
            let fell = self.scale.begun() && self.surface_z - before > 2.0 * self.radius;
            self.unproven = self.unproven.filter(|_| !fell);
            let seen = if known { Below::Known } else { Below::New };
            self.update_scale(distance * cos, then.q, seen);
            let mut band = self.band.unwrap_or(below);
            band.top = self.surface_z.min(before);
            let reach = band.top - then.position.z;
            let at = |m: &StateSnapshot| m.position + beam(m.q, reach, yaw_offset);
            let displacement = at(then) - at(earlier);
            self.band = Some(PipeFootprint::at_edge(
                band,
                self.stepped_at,
                onto,
                displacement,
                heading,
            ));
            self.surface_point = surface_point;
            self.flank = if onto && !known { FLANK_RANGES } else { 0 };
        }
        None
    }

    /// A range that is `off`, m, by more than `gate` deviations is a mixture of both surfaces, unless that lasts longer than
    /// an edge passes the beam: then the height is wrong.
    fn is_mixture(&mut self, off: f32, gate: f32, variance: f32) -> bool {
        let apart = off * off > gate * gate * variance;
        self.mixtures = if apart { self.mixtures.saturating_add(1) } else { 0 };
        (1..=MIXTURES).contains(&self.mixtures)
    }

    /// Switches to another surface; true if it is a known one, which is at most `within` m off.
    fn change_surface(&mut self, surface: f32, within: f32, now: u64) -> bool {
        self.step = SurfaceStep::default();
        // A known surface is used again.
        let known = [self.base, self.other];
        let again = known.iter().find(|z| (**z - surface).abs() <= within);
        let before = self.surface_z;
        self.surface_z = again.copied().unwrap_or(surface);
        // Down is positive. The surface that the beam falls to is the ground: if the height has drifted since, a
        // deeper ground must not remain, over which the true one would seem raised.
        if self.surface_z > before {
            (self.other, self.base) = (before, self.surface_z);
        } else {
            self.other = self.surface_z;
        }
        let faded = STEPS_RATE * seconds(self.stepped_us, now);
        (self.steps, self.stepped_us) = ((self.steps - faded).max(0.0) + 1.0, now);
        if self.steps > STEPS_MAX {
            self.distrusted_us = now.saturating_add(DISTRUST);
            self.steps = 0.0;
        }
        again.is_some()
    }

    /// A narrow object is below.
    pub(crate) fn raised(&self) -> bool {
        self.base - self.surface_z > STEP
    }

    /// Effective distance of the flow's scene from `to`. Beside a narrow object the rest of the view is farther; if an
    /// edge of the object was seen, its share of the view is known.
    pub(crate) fn depth(&self, to: &StateSnapshot, cos: f32, yaw_offset: f32) -> Depth {
        let far = |surface_z: f32| {
            let (least, most) = FLOW_HEIGHT;
            scalar::clamp((surface_z - to.position.z) / cos, least, 2.0 * most)
        };
        let near = far(self.surface_z);
        let surface_point = to.position + beam(to.q, near, yaw_offset);
        let seen = match self.band {
            Some(band) => band.depth(to.position, surface_point, far(self.base), self.texture.weight()),
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
        if self.step.begun() || self.flank > 0 || distance < JUDGED {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// In other axes the places of the ones before are none, and a flank that was half seen no longer keeps the flow
    /// from being judged.
    #[test]
    fn a_new_estimate_drops_the_places_of_the_previous_axes() {
        let mut flow_range = FlowRangeFusion::new(0.3, Vec3::ZERO);
        let at = |us: u64, y: f32| StateSnapshot {
            at_us: us,
            position: Vec3::new(7.0, y, -1.9),
            q: Quat::IDENTITY,
            ..StateSnapshot::default()
        };
        for (y, distance) in [(0.5, 1.9), (0.7, 0.4)] {
            for i in 0..5u8 {
                let y = y + 0.015 * f32::from(i);
                let _ = flow_range.height((&at(0, y - 0.02), &at(0, y)), distance, (1e-4, false), 0.0);
            }
        }
        assert!(flow_range.flank > 0 && flow_range.unproven.is_some() && flow_range.surface_point.x > 6.9);
        flow_range.range = Some((20_000, 1.0));
        let flow = Flow {
            until_us: 20_000,
            seconds: 0.02,
            angle: [0.0; 2],
            quality: 100,
        };
        assert_eq!(flow_range.begin(&flow, Quat::IDENTITY), Some(1.0));
        assert_eq!((flow_range.flank, flow_range.step), (0, SurfaceStep::default()));
        assert!(
            flow_range.surface_point.norm() < 1e-6,
            "{:?}",
            flow_range.surface_point
        );
        assert!(flow_range.unproven.is_some_and(|first| first.norm() < 1e-6));
    }

    /// The beam drifts over the edge of the pipe at 5 cm/s: what it reads between both moves the height by less than 2 cm.
    #[test]
    fn a_mixture_of_pipe_and_ground_does_not_move_the_height() {
        let mut flow_range = FlowRangeFusion::new(0.3, Vec3::ZERO);
        let at = |us: u64, y: f32| StateSnapshot {
            at_us: us,
            position: Vec3::new(0.0, y, -1.9),
            q: Quat::IDENTITY,
            ..StateSnapshot::default()
        };
        let known_to = 1e-4;
        let mut y = 0.5;
        let mut shift = 0.0;
        let mut fly = |metres: f32, speed: f32, range: &dyn Fn(f32) -> f32| {
            let end = y + metres;
            while y < end {
                y += 0.02 * speed;
                let moments = (&at(0, y - 0.1 * speed), &at(0, y));
                let found = flow_range.height(moments, range(y), (known_to, false), 0.0);
                // As the height follows.
                shift += found.map_or(0.0, |(off, variance)| off * known_to / (known_to + variance));
            }
        };
        // The pipe's crown is 0.4 m below at 0.95 m, its edges are at 0.8 and 1.1 m.
        let share = |y: f32| (0.5 + (0.15 - (y - 0.95).abs()) / 0.042).clamp(0.0, 1.0);
        let read = |y: f32| {
            let (pipe, ground) = (share(y) / (0.4 * 0.4), (1.0 - share(y)) / (1.9 * 1.9));
            (pipe * 0.4 + ground * 1.9) / (pipe + ground)
        };
        fly(0.45, 0.3, &read);
        fly(0.3, 0.05, &read);
        fly(0.3, 0.3, &read);
        assert!(shift.abs() < 0.02, "{shift}");
        assert!(!flow_range.raised() && flow_range.surface_z.abs() < 0.02);
    }
}
