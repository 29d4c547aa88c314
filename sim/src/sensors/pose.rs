//! A visual odometry or motion capture that sends poses: late, noisy, with gaps, in axes of its own that slowly turn
//! (values assumed).

mod dropout;
mod tag;

use std::collections::VecDeque;
use std::f64::consts::PI;

use crate::normal::StandardNormal;
use glam::{DQuat, DVec3};
use rand::Rng;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use self::dropout::Dropout;
use self::tag::Tag;
use crate::plant::contact::Pose;
use crate::streams::Streams;

/// Time between two measurements, ms: 50 a second.
const PERIOD_MS: u64 = 20;
/// Delay from measurement to the line, µs.
const DELAY_US: u64 = 30_000;
/// White noise along each axis, m, and of each angle, rad.
const NOISE: f64 = 3e-3;
const ANGLE_NOISE: f64 = 3e-3;
/// Constant error along each axis, m RMS.
const CONSTANT: f64 = 5e-3;
/// Poses per position of the pipe (10 a second), and the constant error of that position along each axis, m RMS.
const TARGET_EACH: u64 = 5;
const TARGET_CONSTANT: f64 = 5e-3;
/// Distance of an implausible position of the pipe, m.
const TARGET_FAR: f64 = 50.0;
/// Largest yaw of its axes at the start, rad, and their yaw rate, rad/s: 1° a minute.
const TURN: f64 = PI;
const TURN_RATE: f64 = PI / 180.0 / 60.0;
/// Length of a gap without poses, s, and time between two gaps, s.
const GAP: (f64, f64) = (0.3, 1.0);
const BETWEEN: (f64, f64) = (10.0, 40.0);

/// Sizes of the faults: factor on translations, jump, m, and time between two jumps, ms.
const SCALED: f64 = 2.5;
const JUMP: f64 = 0.6;
const JUMP_MS: u64 = 300;

/// Losses and outliers of a source that sees a tag.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TagSpec {
    /// Edge of the tag, m; `None`: the noise is the same everywhere.
    pub size: Option<f64>,
    /// Share of the poses that are turned about the tag, 0..1.
    pub outliers: f64,
    /// Share of the poses that are lost in bursts, 0..1.
    pub dropout: f64,
}

/// A measurement in the source's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Time of the measurement, µs after power-up.
    pub at_us: u64,
    /// Position, m, down as the world's.
    pub position: DVec3,
    /// Rotation from body axes to the source's axes.
    pub attitude: DQuat,
    /// Position of the pipe's crown, m, and heading of the pipe, rad, with every fifth pose.
    pub target: Option<(DVec3, f64)>,
}

/// Fault of a source of poses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PoseFault {
    /// It sends nothing.
    #[default]
    Silent,
    /// It repeats its last pose.
    Frozen,
    /// Its position jumps by 0.6 m, back and forth.
    Jumps,
    /// Translations along its second axis have the wrong sign.
    Mirrored,
    /// Translations are 2.5 times too long.
    Scaled,
    /// Its heading is off by half a right angle.
    Turned,
    /// It sends no position of the pipe.
    TargetSilent,
    /// The position of the pipe jumps by 0.6 m, back and forth.
    TargetJumps,
    /// The position of the pipe is off by 50 m.
    TargetFar,
}

/// The source.
#[derive(Clone, Debug)]
pub struct PoseSource {
    rng: Pcg64Mcg,
    /// Time since power-up, ms.
    ms: u64,
    /// Last true position, and the source's own path since the start, m.
    before: Option<DVec3>,
    gone: DVec3,
    constant: DVec3,
    /// The pipe's crown in world axes with its error, m; `None` without a search for the pipe.
    pipe: Option<DVec3>,
    turn: f64,
    turn_rate: f64,
    /// Begin and end of the next gap, and of the failure, ms.
    gap: (u64, u64),
    failure: (u64, u64),
    fault: PoseFault,
    /// Last pose before it froze.
    held: Option<(DVec3, DQuat)>,
    dropout: Dropout,
    tag: Option<Tag>,
    sent: VecDeque<Measured>,
}

impl PoseSource {
    /// A source with the errors of `streams`.
    #[must_use]
    pub fn new(streams: Streams) -> Self {
        let mut rng = streams.of("pose");
        let constant = normal(&mut rng) * CONSTANT;
        let gap = gap(&mut rng, 0);
        Self {
            rng,
            ms: 0,
            before: None,
            gone: DVec3::ZERO,
            constant,
            pipe: None,
            turn: streams.within("pose.turn", -TURN, TURN),
            turn_rate: streams.within("pose.turn_rate", -TURN_RATE, TURN_RATE),
            gap,
            failure: (0, 0),
            fault: PoseFault::Silent,
            held: None,
            dropout: Dropout::new(0.0, streams),
            tag: None,
            sent: VecDeque::new(),
        }
    }

    /// The same with a search for the pipe, whose crown is assumed at `crown_position` in world axes, m.
    #[must_use]
    pub fn seeing(self, crown_position: DVec3, streams: Streams) -> Self {
        let off = normal(&mut streams.of("pose.target")) * TARGET_CONSTANT;
        Self {
            pipe: Some(crown_position + off),
            ..self
        }
    }

    /// The same with the losses and outliers of `spec`, by a tag at `place` (m, NED).
    #[must_use]
    pub fn tagged(self, place: DVec3, spec: &TagSpec, streams: Streams) -> Self {
        let &TagSpec {
            size,
            outliers,
            dropout,
        } = spec;
        let tag = Tag::new(place, size, outliers, streams);
        Self {
            dropout: Dropout::new(dropout, streams),
            tag: (size.is_some() || outliers > 0.0).then_some(tag),
            ..self
        }
    }

    /// The same, with `fault` from `at` s after power-up for `seconds`.
    #[must_use]
    pub fn failing(self, fault: PoseFault, at: f64, seconds: f64) -> Self {
        let failure = ((at * 1e3) as u64, ((at + seconds) * 1e3) as u64);
        Self {
            fault,
            failure,
            ..self
        }
    }

    /// Advances by a millisecond to the vehicle's `pose`.
    pub fn step(&mut self, pose: &Pose) {
        self.ms += 1;
        self.turn += self.turn_rate * 1e-3;
        let axes = DQuat::from_rotation_z(self.turn);
        let before = self.before.replace(pose.position).unwrap_or_default();
        let (fails, recovers) = self.failure;
        let fault = (fails..recovers).contains(&self.ms).then_some(self.fault);
        let way = axes * (pose.position - before);
        self.gone += match fault {
            Some(PoseFault::Mirrored) => way * DVec3::new(1.0, -1.0, 1.0),
            Some(PoseFault::Scaled) => way * SCALED,
            _ => way,
        };
        let (begins, ends) = self.gap;
        if self.ms >= ends {
            self.gap = gap(&mut self.rng, self.ms);
        }
        let silent = (begins..ends).contains(&self.ms) || fault == Some(PoseFault::Silent);
        if silent || !self.ms.is_multiple_of(PERIOD_MS) {
            return;
        }
        let mut position = self.gone + self.constant + normal(&mut self.rng) * NOISE;
        let error = DQuat::from_scaled_axis(normal(&mut self.rng) * ANGLE_NOISE);
        let mut attitude = (axes * pose.attitude * error).normalize();
        if let Some(tag) = &mut self.tag {
            let error = tag.error(pose);
            position += axes * error.offset;
            attitude = (axes * error.turn * axes.inverse() * attitude).normalize();
        }
        match fault {
            Some(PoseFault::Frozen) => {
                (position, attitude) = *self.held.get_or_insert((position, attitude));
            }
            Some(PoseFault::Jumps) if (self.ms / JUMP_MS).is_multiple_of(2) => position.x += JUMP,
            Some(PoseFault::Turned) => attitude = DQuat::from_rotation_z(PI / 4.0) * attitude,
            _ => self.held = None,
        }
        let target = self.target(pose, axes, fault);
        if self.dropout.next() {
            return;
        }
        self.sent.push_back(Measured {
            at_us: self.ms * 1000,
            position,
            attitude,
            target,
        });
    }

    /// Crown and heading of the pipe in the source's axes; the pipe runs along the world's first axis.
    fn target(&mut self, pose: &Pose, axes: DQuat, fault: Option<PoseFault>) -> Option<(DVec3, f64)> {
        let due = self.ms.is_multiple_of(TARGET_EACH * PERIOD_MS);
        let pipe = self
            .pipe
            .filter(|_| due && fault != Some(PoseFault::TargetSilent))?;
        // The axes move against the world by the error of its path.
        let mut seen = self.gone + self.constant + axes * (pipe - pose.position);
        seen += normal(&mut self.rng) * NOISE;
        match fault {
            Some(PoseFault::TargetJumps) if (self.ms / JUMP_MS).is_multiple_of(2) => seen.y += JUMP,
            Some(PoseFault::TargetFar) => seen.x += TARGET_FAR,
            _ => (),
        }
        Some((seen, self.turn))
    }

    /// Converts `position` from the source's present axes to world axes, m.
    #[must_use]
    pub fn in_world(&self, position: DVec3) -> DVec3 {
        let axes = DQuat::from_rotation_z(self.turn);
        self.before.unwrap_or_default() + axes.inverse() * (position - self.gone)
    }

    /// The oldest measurement that has arrived `us` µs after power-up.
    pub fn take(&mut self, us: u64) -> Option<Measured> {
        self.sent.front().filter(|m| m.at_us + DELAY_US <= us)?;
        self.sent.pop_front()
    }
}

fn normal(rng: &mut Pcg64Mcg) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| StandardNormal.sample(rng)))
}

/// Begin and end of the first gap after `ms`.
fn gap(rng: &mut Pcg64Mcg, ms: u64) -> (u64, u64) {
    let begins = ms + (rng.random_range(BETWEEN.0..BETWEEN.1) * 1e3) as u64;
    (begins, begins + (rng.random_range(GAP.0..GAP.1) * 1e3) as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: DVec3) -> Pose {
        Pose {
            position,
            attitude: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            omega: DVec3::ZERO,
        }
    }

    #[test]
    fn it_is_late_noisy_and_has_gaps() {
        let mut source = PoseSource::new(Streams::new(5));
        let (mut times, mut places) = (vec![], vec![]);
        for ms in 1..=120_000_u64 {
            source.step(&at(DVec3::new(1.0, 2.0, -3.0)));
            while let Some(m) = source.take(ms * 1000) {
                assert_eq!(m.at_us + DELAY_US, ms * 1000);
                times.push(m.at_us);
                places.push(m.position);
            }
        }
        let gaps: Vec<u64> = times
            .windows(2)
            .map(|t| t[1] - t[0])
            .filter(|gap| *gap > 20_000)
            .collect();
        assert!((3..=12).contains(&gaps.len()), "{gaps:?}");
        assert!(
            gaps.iter().all(|gap| (300_000..=1_040_000).contains(gap)),
            "{gaps:?}"
        );
        let mean = places.iter().sum::<DVec3>() / places.len() as f64;
        let rms =
            (places.iter().map(|p| (*p - mean).length_squared()).sum::<f64>() / places.len() as f64).sqrt();
        assert!((rms / (3f64.sqrt() * NOISE) - 1.0).abs() < 0.05, "{rms}");
    }

    #[test]
    fn its_axes_are_its_own_and_the_way_in_them_is_as_long() {
        let mut source = PoseSource::new(Streams::new(6));
        let mut seen = vec![];
        for ms in 1..=2_000_u64 {
            source.step(&at(DVec3::new(ms as f64 * 1e-3, 0.0, 0.0)));
            seen.extend(source.take(ms * 1000));
        }
        let (first, last) = (seen.first().unwrap(), seen.last().unwrap());
        let way = last.position - first.position;
        let time = (last.at_us - first.at_us) as f64 * 1e-6;
        assert!((way.length() / time - 1.0).abs() < 0.02, "{way}");
        // The nose points along the path.
        let nose = last.attitude * DVec3::X;
        assert!(nose.dot(way.normalize()) > 0.999, "{nose} {way}");
    }
}
