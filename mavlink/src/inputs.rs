//! Measurements of other computers: external poses, flow and range, and the place of the pipe. Each is checked, turned
//! into the vehicle's axes, and dated with its time of measurement. The position estimate uses them.
//!
//! Each input has one source at a time: two alternating sources would mix two origins, mountings or pipes. A refused
//! input changes nothing.

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

/// Largest error of a quaternion's squared length: senders round, and do not always normalise.
const QUATERNION_TOLERANCE: f32 = 0.02;
/// Silence of a source after which another one may replace it, µs: four periods of the slowest input, `LANDING_TARGET`.
/// Not less than `AGE_MAX`, so that no time of the new source lies before the last one of the old.
const SILENCE: u64 = 2_000_000;
const _: () = assert!(SILENCE >= AGE_MAX);

/// Reason for refusing an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// The sender belongs to another system, whose inputs are not enabled.
    System,
    /// The input has another source.
    Source,
    /// Its frame is not supported.
    Frame,
    /// A value is not a number or out of bounds, or its sender marks it as bad.
    Value,
    /// Measured too long ago, or not after the one before.
    Late,
}

/// Accepted and refused inputs since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Accepted poses.
    pub poses: u32,
    /// Accepted flows and ranges.
    pub views: u32,
    /// Accepted places of the pipe.
    pub targets: u32,
    /// Refused: sender of another system.
    pub system: u32,
    /// Refused: another source is active.
    pub source: u32,
    /// Refused: unsupported frame.
    pub frame: u32,
    /// Refused: bad value.
    pub value: u32,
    /// Refused: too old or out of order.
    pub late: u32,
}

/// An input with a source of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Input {
    Pose,
    Flow,
    Range,
    Target,
}

/// Number of inputs.
const INPUTS: usize = 4;

/// Source of an input: its sender, and the sensor or message of that sender.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Source {
    peer: Peer,
    sensor: u8,
}

/// A received message.
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
    /// Measurement time of the last accepted message, µs since the start; 0 before the first.
    measured_at: u64,
    /// Its time of receipt, µs since the start.
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
    /// Another system whose inputs are accepted beside the vehicle's own; 0 for no other.
    other_system: u8,
    /// Flow and range come from a module at the vehicle's own port, and those over MAVLink are refused.
    own_module: bool,
    streams: [Stream; INPUTS],
    pose: Option<ExternalPose>,
    /// Reset counter of the newest pose, and its offset to its source's counter: a change of source counts as a reset.
    resets: u8,
    more_resets: u8,
    target: Option<PipeTarget>,
    ground: GroundView,
    /// `ground` has changed since [`Self::take_ground`].
    seen: bool,
    counts: Counts,
}

impl Inputs {
    /// Before the first input.
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

    /// Accepted and refused inputs since the start.
    pub const fn counts(&self) -> Counts {
        self.counts
    }

    fn stream(&self, input: Input) -> Stream {
        self.streams.get(input as usize).copied().unwrap_or_default()
    }

    /// The measurement time of `arrival`, if it is accepted. `sound` is the check of its content. Changes nothing.
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

    /// Accepts or refuses `arrival`: its measurement time if accepted, and true if its sender must be asked for its
    /// time.
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
        // A known sender that is late may have restarted with a new clock.
        let asks = matches!(taken, Ok(_) | Err(Refusal::Late)) && self.clocks.due(source.peer, now);
        (taken.ok(), asks)
    }

    /// Takes a pose of `from`: message `id`, time stamp `usec` of the sender's clock, received at `now`, µs since the
    /// start. True if the sender must be asked for its time.
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

    /// Takes a flow and its range, as [`Self::pose`] takes a pose.
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
            // A range sensor's own message has priority, since it also has the sensor's reach.
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

    /// The newest pose since the last call.
    pub const fn take_pose(&mut self) -> Option<ExternalPose> {
        self.pose.take()
    }

    /// Flow and range, if one of them has changed since the last call.
    pub fn take_ground(&mut self) -> Option<GroundView> {
        core::mem::take(&mut self.seen).then_some(self.ground)
    }

    /// The newest place of the pipe since the last call.
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

/// A vector whose components are numbers within ±`most`; refused otherwise.
fn bounded([x, y, z]: [f32; 3], most: f32) -> Result<Vec3, Refusal> {
    let within = [x, y, z].iter().all(|value| value.abs() <= most);
    within.then_some(Vec3::new(x, y, z)).ok_or(Refusal::Value)
}

/// A rotation; `None` if the first component is NaN, which means "not given".
fn rotation([w, x, y, z]: [f32; 4]) -> Result<Option<Quat>, Refusal> {
    if w.is_nan() {
        return Ok(None);
    }
    let off = (w * w + x * x + y * y + z * z - 1.0).abs();
    let unit = (off <= QUATERNION_TOLERANCE).then_some(Quat { w, x, y, z }.normalised());
    unit.map(Some).ok_or(Refusal::Value)
}
