//! What others measure and wish: an external pose, flow and range, and an offboard attitude, checked, in the vehicle's axes, with the time
//! of measurement. The position hold flies by the poses; nothing flies by the attitudes yet.

pub mod attitude;
pub mod clock;
pub mod ground;
pub mod pose;
pub mod target;

use self::attitude::OffboardAttitude;
use self::clock::Clock;
use self::pose::{ExternalPose, Pose};
use crate::dialect::{DISTANCE_SENSOR_DATA, LANDING_TARGET_DATA, OPTICAL_FLOW_RAD_DATA};
use crate::requests::Peer;
use sophie_control::ground::GroundView;
use sophie_control::target::PipeTarget;
use sophie_control::vector::{Quat, Vec3};

/// Squared length of a quaternion may be off by this much: senders round, and do not always normalise.
const QUATERNION_TOLERANCE: f32 = 0.02;

/// Why an input was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its axes are not known here.
    Frame,
    /// A value is no number, out of bounds, or said by its sender to be bad.
    Value,
    /// Measured too long ago, or not after the one before.
    Late,
}

/// Inputs since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Poses taken.
    pub poses: u32,
    /// Flows and ranges taken.
    pub views: u32,
    /// Places of the pipe taken.
    pub targets: u32,
    /// Attitudes taken.
    pub attitudes: u32,
    /// Refused for their axes.
    pub frame: u32,
    /// Refused for their values.
    pub value: u32,
    /// Refused for their time.
    pub late: u32,
}

impl core::ops::Add for Counts {
    type Output = Self;

    fn add(self, more: Self) -> Self {
        Self {
            poses: self.poses.saturating_add(more.poses),
            views: self.views.saturating_add(more.views),
            targets: self.targets.saturating_add(more.targets),
            attitudes: self.attitudes.saturating_add(more.attitudes),
            frame: self.frame.saturating_add(more.frame),
            value: self.value.saturating_add(more.value),
            late: self.late.saturating_add(more.late),
        }
    }
}

/// The newest inputs of a line.
#[derive(Clone, Debug, Default)]
pub struct Inputs {
    /// The senders' clock.
    pub(crate) clock: Clock,
    pose: Option<ExternalPose>,
    attitude: Option<OffboardAttitude>,
    target: Option<PipeTarget>,
    /// When the place of the pipe before was measured, µs.
    target_at: u64,
    ground: GroundView,
    /// Something of it has come since it was taken.
    seen: bool,
    /// When the pose before was measured, µs.
    measured_at: u64,
    counts: Counts,
}

impl Inputs {
    /// Before the first.
    pub const fn new() -> Self {
        Self {
            clock: Clock::new(),
            pose: None,
            attitude: None,
            target: None,
            target_at: 0,
            ground: GroundView {
                flow: None,
                range: None,
            },
            seen: false,
            measured_at: 0,
            counts: Counts {
                poses: 0,
                views: 0,
                targets: 0,
                attitudes: 0,
                frame: 0,
                value: 0,
                late: 0,
            },
        }
    }

    /// Inputs since the start.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    /// Takes a pose that `from` sent with the time `usec` of its clock and that arrived at `now`, µs since the start. True
    /// where the sender is to be asked for its time.
    pub(crate) fn pose(&mut self, pose: Result<Pose, Refusal>, usec: u64, from: Peer, now: u64) -> bool {
        let stamped = pose.and_then(|pose| {
            let time = self.clock.time(usec, from, now)?;
            // 0 before the first.
            let in_order = self.measured_at == 0 || time.at > self.measured_at;
            in_order.then_some((pose, time)).ok_or(Refusal::Late)
        });
        match stamped {
            Ok((pose, time)) => {
                count(&mut self.counts.poses);
                self.measured_at = time.at;
                self.pose = Some(ExternalPose {
                    pose,
                    measured_at: time.at,
                    received_at: now,
                    clock: time.source,
                });
            }
            Err(refusal) => self.refuse(refusal),
        }
        self.clock.due(from, now)
    }

    /// Takes a flow, and the range that comes with it, as [`Self::pose`] takes a pose.
    pub(crate) fn flow(&mut self, m: &OPTICAL_FLOW_RAD_DATA, from: Peer, now: u64) -> bool {
        let before = self.ground.flow.map_or(0, |flow| flow.until_us);
        let taken = self.clock.time(m.time_usec, from, now).and_then(|time| {
            let (flow, range) = ground::flow(m, time.at)?;
            (flow.until_us > before)
                .then_some((flow, range))
                .ok_or(Refusal::Late)
        });
        match taken {
            Ok((flow, range)) => {
                self.ground.flow = Some(flow);
                self.ground.range = range.or(self.ground.range);
                self.saw();
            }
            Err(refusal) => self.refuse(refusal),
        }
        self.clock.due(from, now)
    }

    /// Takes a range, as [`Self::pose`] takes a pose.
    pub(crate) fn range(&mut self, m: &DISTANCE_SENSOR_DATA, from: Peer, now: u64) -> bool {
        let before = self.ground.range.map_or(0, |range| range.at_us);
        let usec = u64::from(m.time_boot_ms) * 1000;
        let taken = self.clock.time(usec, from, now).and_then(|time| {
            let range = ground::range(m, time.at)?;
            (range.at_us > before).then_some(range).ok_or(Refusal::Late)
        });
        match taken {
            Ok(range) => {
                self.ground.range = Some(range);
                self.saw();
            }
            Err(refusal) => self.refuse(refusal),
        }
        self.clock.due(from, now)
    }

    /// Takes the place of the pipe, as [`Self::pose`] takes a pose.
    pub(crate) fn target(&mut self, m: &LANDING_TARGET_DATA, from: Peer, now: u64) -> bool {
        let taken = self.clock.time(m.time_usec, from, now).and_then(|time| {
            let target = target::target(m, time.at)?;
            (target.at_us > self.target_at)
                .then_some(target)
                .ok_or(Refusal::Late)
        });
        match taken {
            Ok(target) => {
                count(&mut self.counts.targets);
                self.target_at = target.at_us;
                self.target = Some(target);
            }
            Err(refusal) => self.refuse(refusal),
        }
        self.clock.due(from, now)
    }

    /// The place of the pipe that has come since the last call.
    pub const fn take_target(&mut self) -> Option<PipeTarget> {
        self.target.take()
    }

    const fn saw(&mut self) {
        count(&mut self.counts.views);
        self.seen = true;
    }

    /// Flow and range, where something of them has come since the last call.
    pub fn take_ground(&mut self) -> Option<GroundView> {
        core::mem::take(&mut self.seen).then_some(self.ground)
    }

    /// Takes an attitude that arrived.
    pub(crate) fn attitude(&mut self, attitude: Result<OffboardAttitude, Refusal>) {
        match attitude {
            Ok(attitude) => {
                count(&mut self.counts.attitudes);
                self.attitude = Some(attitude);
            }
            Err(refusal) => self.refuse(refusal),
        }
    }

    /// The pose that has come since the last call.
    pub const fn take_pose(&mut self) -> Option<ExternalPose> {
        self.pose.take()
    }

    /// The attitude that has come since the last call.
    pub const fn take_attitude(&mut self) -> Option<OffboardAttitude> {
        self.attitude.take()
    }

    const fn refuse(&mut self, refusal: Refusal) {
        count(match refusal {
            Refusal::Frame => &mut self.counts.frame,
            Refusal::Value => &mut self.counts.value,
            Refusal::Late => &mut self.counts.late,
        });
    }
}

const fn count(counter: &mut u32) {
    *counter = counter.saturating_add(1);
}

/// A vector whose components are numbers within ±`most`.
fn bounded([x, y, z]: [f32; 3], most: f32) -> Result<Vec3, Refusal> {
    let within = [x, y, z].iter().all(|value| value.abs() <= most);
    within.then_some(Vec3::new(x, y, z)).ok_or(Refusal::Value)
}

/// A rotation; `None` where the first component is NaN: not given.
fn rotation([w, x, y, z]: [f32; 4]) -> Result<Option<Quat>, Refusal> {
    if w.is_nan() {
        return Ok(None);
    }
    let off = (w * w + x * x + y * y + z * z - 1.0).abs();
    let unit = (off <= QUATERNION_TOLERANCE).then_some(Quat { w, x, y, z }.normalised());
    unit.map(Some).ok_or(Refusal::Value)
}
