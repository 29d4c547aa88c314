//! What others measure and wish: an external pose, flow and range, the place of the pipe, and an offboard attitude, checked, in
//! the vehicle's axes, with the time of measurement. The position hold flies by the poses; nothing flies by the attitudes yet.
//!
//! Each input has one source at a time: two that alternate would have two origins, mountings or pipes. What is refused changes
//! nothing.

pub mod clock;
pub mod ground;
pub mod pose;
pub mod target;

use self::clock::{AGE_MAX, Clocks, Stamp, Time};
use crate::wire::frame::SYSTEM;
use crate::wire::requests::Peer;
use sophie_control::approach::pipe_target::PipeTarget;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::flow_range_sample::{Flow, GroundView, Range};
use sophie_control::params::{FlowPort, Params};
use sophie_dialect::{DISTANCE_SENSOR_DATA, LANDING_TARGET_DATA, OPTICAL_FLOW_RAD_DATA};
use sophie_ports::external_pose::{ExternalPose, Pose};

/// Squared length of a quaternion may be off by this much: senders round, and do not always normalise.
const QUATERNION_TOLERANCE: f32 = 0.02;
/// Silence of a source after which another may be it, µs: four periods of the slowest input, `LANDING_TARGET`. Not less than
/// the oldest that is taken, so that no other source's time lies before the last one's.
const SILENCE: u64 = 2_000_000;
const _: () = assert!(SILENCE >= AGE_MAX);

/// Why an input was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// Its sender belongs to a system whose inputs are not wanted.
    System,
    /// It has another source already.
    Source,
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
    /// Refused for their senders' system.
    pub system: u32,
    /// Refused beside another source.
    pub source: u32,
    /// Refused for their axes.
    pub frame: u32,
    /// Refused for their values.
    pub value: u32,
    /// Refused for their time.
    pub late: u32,
}

/// What has a source of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Input {
    Pose,
    Flow,
    Range,
    Target,
}

/// How many these are.
const INPUTS: usize = 4;

/// Where an input comes from: its sender, and which of that sender's sensors or messages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Source {
    peer: Peer,
    sensor: u8,
}

/// A message that arrived.
#[derive(Clone, Copy, Debug)]
struct Arrival {
    input: Input,
    source: Source,
    stamp: Stamp,
    /// µs since the start.
    now: u64,
}

/// The source of an input.
#[derive(Clone, Copy, Debug, Default)]
struct Stream {
    of: Option<Source>,
    /// When the last that was taken was measured, µs since the start; 0 before the first.
    measured_at: u64,
    /// When it arrived, µs.
    taken_at: u64,
}

impl Stream {
    fn silent(&self, now: u64) -> bool {
        self.of.is_none() || now.saturating_sub(self.taken_at) > SILENCE
    }
}

/// The newest inputs of all lines.
#[derive(Clone, Debug)]
pub struct Inputs {
    /// The senders' clocks.
    pub(crate) clocks: Clocks,
    /// The system whose inputs are taken beside the vehicle's own; 0 for none.
    other_system: u8,
    /// Flow and range come from the vehicle's own port.
    own_module: bool,
    streams: [Stream; INPUTS],
    pose: Option<ExternalPose>,
    /// Resets of the newest pose, and what they are more than its source's: another source is a reset as well.
    resets: u8,
    more_resets: u8,
    target: Option<PipeTarget>,
    ground: GroundView,
    /// Something of it has come since it was taken.
    seen: bool,
    counts: Counts,
}

impl Inputs {
    /// Before the first.
    pub fn new(params: &Params) -> Self {
        Self {
            clocks: Clocks::default(),
            other_system: params.mav_inputs_sys as u8,
            own_module: params.flow_port != FlowPort::Closed,
            streams: [Stream::default(); INPUTS],
            pose: None,
            resets: 0,
            more_resets: 0,
            target: None,
            ground: GroundView::default(),
            seen: false,
            counts: Counts::default(),
        }
    }

    /// Inputs since the start.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    fn stream(&self, input: Input) -> Stream {
        self.streams.get(input as usize).copied().unwrap_or_default()
    }

    /// The time of measurement of what arrived, whose content is `sound` or is refused for it. Changes nothing.
    fn judge(&self, arrival: &Arrival, sound: Result<(), Refusal>) -> Result<Time, Refusal> {
        let &Arrival {
            input,
            source,
            stamp,
            now,
        } = arrival;
        let system = source.peer.system;
        if system != SYSTEM && (system == 0 || system != self.other_system) {
            return Err(Refusal::System);
        }
        sound?;
        let stream = self.stream(input);
        let own = self.own_module && matches!(input, Input::Flow | Input::Range);
        if own || (stream.of != Some(source) && !stream.silent(now)) {
            return Err(Refusal::Source);
        }
        let time = self.clocks.time(stamp, source.peer, now)?;
        let in_order = stream.measured_at == 0 || time.at > stream.measured_at;
        in_order.then_some(time).ok_or(Refusal::Late)
    }

    /// The time of measurement where the arrival is taken, and whether its sender is to be asked for its time.
    fn take(&mut self, arrival: &Arrival, sound: Result<(), Refusal>) -> (Option<Time>, bool) {
        let &Arrival {
            input, source, now, ..
        } = arrival;
        let taken = self.judge(arrival, sound);
        if let Ok(time) = taken {
            if let Some(stream) = self.streams.get_mut(input as usize) {
                *stream = Stream {
                    of: Some(source),
                    measured_at: time.at,
                    taken_at: now,
                };
            }
            let streams = &self.streams;
            self.clocks.keep(source.peer, |peer| {
                streams.iter().filter_map(|s| s.of).any(|of| of.peer == peer)
            });
        }
        if let Err(refusal) = taken {
            self.refuse(refusal);
        }
        // One whose clock is kept and that is late may have a new clock: it started again.
        let asks = matches!(taken, Ok(_) | Err(Refusal::Late)) && self.clocks.due(source.peer, now);
        (taken.ok(), asks)
    }

    /// Takes a pose that `from` sent in message `id` with the time `usec` of its clock and that arrived at `now`, µs since the
    /// start. True where the sender is to be asked for its time.
    pub(crate) fn pose(
        &mut self,
        pose: Result<Pose, Refusal>,
        id: u32,
        usec: u64,
        from: Peer,
        now: u64,
    ) -> bool {
        let arrival = Arrival {
            input: Input::Pose,
            source: Source {
                peer: from,
                sensor: id as u8,
            },
            stamp: Stamp::Micros(usec),
            now,
        };
        let before = self.stream(Input::Pose).of;
        let (time, asks) = self.take(&arrival, pose.as_ref().map(|_| ()).map_err(|why| *why));
        if let (Some(time), Ok(mut pose)) = (time, pose) {
            count(&mut self.counts.poses);
            if before.is_some_and(|before| before != arrival.source) {
                let next = self.resets.wrapping_add(1);
                self.more_resets = next.wrapping_sub(pose.resets);
            }
            pose.resets = pose.resets.wrapping_add(self.more_resets);
            self.resets = pose.resets;
            self.pose = Some(ExternalPose {
                pose,
                measured_at: time.at,
                received_at: now,
                clock: time.source,
            });
        }
        asks
    }

    /// Takes a flow, and the range that comes with it, as [`Self::pose`] takes a pose.
    pub(crate) fn flow(&mut self, m: &OPTICAL_FLOW_RAD_DATA, from: Peer, now: u64) -> bool {
        let seen = ground::flow(m);
        let arrival = Arrival {
            input: Input::Flow,
            source: Source {
                peer: from,
                sensor: m.sensor_id,
            },
            stamp: Stamp::Micros(m.time_usec),
            now,
        };
        let (time, asks) = self.take(&arrival, seen.map(|_| ()));
        if let (Some(time), Ok((flow, range))) = (time, seen) {
            self.ground.flow = Some(Flow {
                until_us: time.at,
                ..flow
            });
            // A sensor's own message says its reach as well: beside it a flow's range is left.
            if let Some((range, age_us)) = range
                && let Some(ranges) = self.streams.get_mut(Input::Range as usize)
                && ranges.silent(now)
            {
                let at_us = time.at.saturating_sub(age_us);
                if at_us > ranges.measured_at {
                    ranges.measured_at = at_us;
                    self.ground.range = Some(Range { at_us, ..range });
                }
            }
            self.saw();
        }
        asks
    }

    /// Takes a range, as [`Self::pose`] takes a pose.
    pub(crate) fn range(&mut self, m: &DISTANCE_SENSOR_DATA, from: Peer, now: u64) -> bool {
        let range = ground::range(m);
        let arrival = Arrival {
            input: Input::Range,
            source: Source {
                peer: from,
                sensor: m.id,
            },
            stamp: Stamp::Millis(m.time_boot_ms),
            now,
        };
        let (time, asks) = self.take(&arrival, range.map(|_| ()));
        if let (Some(time), Ok(range)) = (time, range) {
            self.ground.range = Some(Range {
                at_us: time.at,
                ..range
            });
            self.saw();
        }
        asks
    }

    /// Takes the place of the pipe, as [`Self::pose`] takes a pose.
    pub(crate) fn target(&mut self, m: &LANDING_TARGET_DATA, from: Peer, now: u64) -> bool {
        let target = target::target(m);
        let arrival = Arrival {
            input: Input::Target,
            source: Source {
                peer: from,
                sensor: m.target_num,
            },
            stamp: Stamp::Micros(m.time_usec),
            now,
        };
        let (time, asks) = self.take(&arrival, target.map(|_| ()));
        if let (Some(time), Ok(target)) = (time, target) {
            count(&mut self.counts.targets);
            self.target = Some(PipeTarget {
                at_us: time.at,
                ..target
            });
        }
        asks
    }

    const fn saw(&mut self) {
        count(&mut self.counts.views);
        self.seen = true;
    }

    /// The pose that has come since the last call.
    pub const fn take_pose(&mut self) -> Option<ExternalPose> {
        self.pose.take()
    }

    /// Flow and range, where something of them has come since the last call.
    pub fn take_ground(&mut self) -> Option<GroundView> {
        core::mem::take(&mut self.seen).then_some(self.ground)
    }

    /// The place of the pipe that has come since the last call.
    pub const fn take_target(&mut self) -> Option<PipeTarget> {
        self.target.take()
    }

    const fn refuse(&mut self, refusal: Refusal) {
        count(match refusal {
            Refusal::System => &mut self.counts.system,
            Refusal::Source => &mut self.counts.source,
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
