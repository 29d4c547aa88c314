//! A module of optical flow and range below the vehicle, of the MTF class: a PMW3901 and a time-of-flight sensor that
//! send MSP frames.
//!
//! | quantity | value | source |
//! |---|---|---|
//! | field of view, nearest, fastest | 42°, 8 cm, 7.4 rad/s | PMW3901's data sheet, the maker's table of the MTF-02 |
//! | range | 2 cm to 2.5 m | the same table |
//! | counts | 10.5 a degree | INAV's default for a PMW3901 |
//! | noise, scale, delay, gaps | below | assumed, as in the feasibility study |

use std::collections::VecDeque;

use glam::{DQuat, DVec3};
use rand::Rng;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_drivers::msp::Message;

use crate::normal::StandardNormal;
use crate::plant::contact::{Pipe, Pose};

use crate::streams::Streams;

/// Default time between two frames, ms: 50 a second.
const PERIOD_MS: u64 = 20;
/// Delay from the end of an interval, or from a range, to the last byte, µs: constant within these limits for a flight,
/// with this jitter for each frame.
const DELAY_US: (u64, u64) = (20_000, 30_000);
const JITTER_US: u64 = 1_500;
/// White noise of the flow of an interval, rad: 0.12 rad/s in 20 ms. An interval of 10 ms has nearly the same
/// (measured).
const FLOW_NOISE: f64 = 0.12 * 1e-3 * PERIOD_MS as f64;
/// Error of the flow's scale after calibration by rotation, RMS share.
const SCALE: f64 = 0.02;
/// Counts of an angle, 1/rad.
const COUNTS: f64 = 10.5 * 180.0 / std::f64::consts::PI;
/// Half the field of view, rad, and the rays along each of its sides.
const HALF_VIEW: f64 = 21.0 / 180.0 * std::f64::consts::PI;
const RAYS: i32 = 9;
/// Time between two pictures, ms.
const LOOK_MS: u64 = 4;
/// Least distance of a picture in focus, m, and fastest flow, rad/s.
const NEAREST: f64 = 0.08;
const FASTEST: f64 = 7.4;
/// Half the beam of the range sensor, rad; its reach, m; white noise, m; error of its scale, RMS share.
const HALF_BEAM: f64 = 3.0 / 180.0 * std::f64::consts::PI;
const REACH: (f64, f64) = (0.02, 2.5);
const RANGE_NOISE: f64 = 0.015;
const RANGE_SCALE: f64 = 0.005;
/// Length of a gap without flow, s, and time between two gaps, s.
const GAP: (f64, f64) = (0.3, 1.0);
const BETWEEN: (f64, f64) = (10.0, 40.0);
/// Sizes of the faults: jump of the flow, counts of an interval (1.5 rad/s), jump of the range, mm, time between two
/// jumps, ms, and factors on the range.
const JUMP: i32 = 18;
const RANGE_JUMP: f64 = 600.0;
const JUMP_MS: u64 = 300;
const LONG: f64 = 1.6;
const SHORT: f64 = 0.6;
/// Quality of a picture with enough texture.
const QUALITY: u8 = 120;

/// Fault of a flow module.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FlowFault {
    /// It sends nothing.
    #[default]
    Silent,
    /// Its pictures are dark: flow of quality 0.
    Dark,
    /// Its flow has the wrong sign.
    Mirrored,
    /// Its flow is 2.5 times as large.
    Scaled,
    /// Its flow repeats.
    Frozen,
    /// Its flow jumps by 1.5 rad/s, back and forth.
    Jumps,
    /// It sends no range.
    RangeSilent,
    /// Its range repeats.
    RangeFrozen,
    /// Its range jumps by 0.6 m, back and forth.
    RangeJumps,
    /// Its range is 1.6 times as long.
    RangeLong,
    /// Its range is 0.6 times as long.
    RangeShort,
}

/// The module.
#[derive(Clone, Debug)]
pub struct FlowModule {
    rng: Pcg64Mcg,
    pipe: Pipe,
    /// Position of both sensors from the centre of mass, m, body.
    lens: DVec3,
    /// Time between two frames, ms, and resolution of its ranges, mm.
    period_ms: u64,
    step_mm: f64,
    /// Time since power-up and time of the last picture, ms.
    ms: u64,
    looked_ms: u64,
    before: Option<(DVec3, DQuat)>,
    /// Flow of this interval, rad, and its remainder below a count.
    angle: [f64; 2],
    rest: [f64; 2],
    seen: bool,
    scale: f64,
    range_scale: f64,
    delay_us: u64,
    gap: (u64, u64),
    fault: FlowFault,
    failure: (u64, u64),
    held: Option<[i32; 2]>,
    held_range: Option<i32>,
    sent: VecDeque<(u64, Vec<u8>)>,
}

impl FlowModule {
    /// A module above the ground and `pipe` with the errors of `streams` and its `lens` at this offset from the centre
    /// of mass, m, body.
    #[must_use]
    pub fn new(streams: Streams, pipe: Pipe, lens: DVec3) -> Self {
        let mut rng = streams.of("flow");
        let scale = 1.0 + SCALE * normal(&mut rng);
        let range_scale = 1.0 + RANGE_SCALE * normal(&mut rng);
        let delay_us = rng.random_range(DELAY_US.0..DELAY_US.1);
        let gap = gap(&mut rng, 0);
        Self {
            rng,
            pipe,
            lens,
            period_ms: PERIOD_MS,
            step_mm: 1.0,
            ms: 0,
            looked_ms: 0,
            before: None,
            angle: [0.0; 2],
            rest: [0.0; 2],
            seen: true,
            scale,
            range_scale,
            delay_us,
            gap,
            fault: FlowFault::Silent,
            failure: (0, 0),
            held: None,
            held_range: None,
            sent: VecDeque::new(),
        }
    }

    /// The same, with `fault` from `at` s after power-up for `seconds`.
    #[must_use]
    pub fn failing(self, fault: FlowFault, at: f64, seconds: f64) -> Self {
        let failure = ((at * 1e3) as u64, ((at + seconds) * 1e3) as u64);
        Self {
            fault,
            failure,
            ..self
        }
    }

    /// The same with frames at `rate` Hz, rounded to a period of whole milliseconds, and a range resolution of `step`
    /// m; `None` keeps the default.
    #[must_use]
    pub fn sending(self, rate: Option<f64>, step: Option<f64>) -> Self {
        Self {
            period_ms: rate.map_or(self.period_ms, |hz| (1e3 / hz).round() as u64),
            step_mm: step.map_or(self.step_mm, |m| 1e3 * m),
            ..self
        }
    }

    /// Advances by a millisecond to the vehicle's `pose`.
    pub fn step(&mut self, pose: &Pose) {
        self.ms += 1;
        let ends = self.ms.is_multiple_of(self.period_ms);
        if !ends && !self.ms.is_multiple_of(LOOK_MS) {
            return;
        }
        let since = self.ms - std::mem::replace(&mut self.looked_ms, self.ms);
        let now = (pose.point(self.lens), pose.attitude);
        if let Some(before) = self.before.replace(now) {
            match self.flow(before, now, since) {
                Some(flow) => self.angle = [self.angle[0] + flow[0], self.angle[1] + flow[1]],
                None => self.seen = false,
            }
        }
        if ends {
            self.measure(now);
        }
    }

    /// The oldest frame that is complete `us` µs after power-up.
    pub fn take(&mut self, us: u64) -> Option<Vec<u8>> {
        self.sent.front().filter(|(at, _)| *at <= us)?;
        self.sent.pop_front().map(|(_, bytes)| bytes)
    }

    fn measure(&mut self, now: (DVec3, DQuat)) {
        let angle = std::mem::take(&mut self.angle);
        let seen = std::mem::replace(&mut self.seen, true);
        let (begins, ends) = self.gap;
        if self.ms >= ends {
            self.gap = gap(&mut self.rng, self.ms);
        }
        let dark = (begins..ends).contains(&self.ms);
        let fault = (self.failure.0..self.failure.1)
            .contains(&self.ms)
            .then_some(self.fault);
        let mut counts = [0; 2];
        for ((count, rest), angle) in counts.iter_mut().zip(&mut self.rest).zip(angle) {
            let noisy = self.scale * angle + FLOW_NOISE * normal(&mut self.rng);
            // The picture moves against the vehicle.
            let whole = *rest - noisy * COUNTS;
            *count = whole.round() as i32;
            *rest = whole - whole.round();
        }
        let distance = self.distance(now);
        let noise = RANGE_NOISE * normal(&mut self.rng);
        let mut distance = distance.map(|d| (d * self.range_scale + noise) * 1e3);
        let mut quality = if seen && !dark { QUALITY } else { 0 };
        let jitter = self.rng.random_range(0..JITTER_US);
        let jumped = (self.ms / JUMP_MS).is_multiple_of(2);
        match fault {
            None => (self.held, self.held_range) = (None, None),
            Some(FlowFault::Silent) => return,
            Some(FlowFault::Dark) => quality = 0,
            Some(FlowFault::Mirrored) => counts = counts.map(|count| -count),
            Some(FlowFault::Scaled) => counts = counts.map(|count| 5 * count / 2),
            Some(FlowFault::Frozen) => counts = *self.held.get_or_insert([counts[0] | 1, counts[1]]),
            Some(FlowFault::Jumps) => {
                let off = if jumped { JUMP } else { -JUMP };
                counts = counts.map(|count| count + off);
            }
            Some(FlowFault::RangeSilent) => distance = None,
            Some(FlowFault::RangeLong) => distance = distance.map(|d| LONG * d),
            Some(FlowFault::RangeShort) => distance = distance.map(|d| SHORT * d),
            Some(FlowFault::RangeFrozen) => {
                let held = *self.held_range.get_or_insert(distance.unwrap_or(1000.0) as i32);
                distance = Some(f64::from(held));
            }
            Some(FlowFault::RangeJumps) => {
                distance = distance.map(|d| if jumped { d + RANGE_JUMP } else { d });
            }
        }
        let flow = Message::Flow { quality, counts };
        let within = |d: &f64| (REACH.0 * 1e3..=REACH.1 * 1e3).contains(d);
        let range = distance.filter(within).map_or(
            Message::Range {
                quality: 0,
                distance: -1,
            },
            |d| Message::Range {
                quality: 255,
                distance: self.in_steps(d) as i32,
            },
        );
        let bytes = range.frame().iter().chain(&flow.frame()).copied().collect();
        let at = self.ms * 1000 + self.delay_us + jitter;
        self.sent.push_back((at, bytes));
    }

    /// A range of `mm` rounded to the module's resolution, mm.
    fn in_steps(&self, mm: f64) -> f64 {
        if self.step_mm > 1.0 {
            (mm / self.step_mm).round() * self.step_mm
        } else {
            mm
        }
    }

    /// Flow between two poses, rad, `ms` apart, in the units of a pure rotation; `None` if the lens is too near, too
    /// fast or sees mostly sky.
    fn flow(&self, from: (DVec3, DQuat), to: (DVec3, DQuat), ms: u64) -> Option<[f64; 2]> {
        let (mut sum, mut weight) = ([0.0; 2], [0.0; 2]);
        let mut rays = 0.0;
        for i in 0..RAYS {
            for j in 0..RAYS {
                // Rays through the centres of equal parts of the view.
                let side =
                    |k: i32| ((f64::from(k) + 0.5) / f64::from(RAYS) * 2.0 - 1.0) * libm::tan(HALF_VIEW);
                let (u, w) = (side(i), side(j));
                // A ray sees texture where it meets a surface; a ray into the sky sees none.
                let direction = to.1 * DVec3::new(u, w, 1.0);
                let Some(way) = self.pipe.or_ground_along(to.0, direction) else {
                    continue;
                };
                if way < NEAREST {
                    return None;
                }
                let point = to.0 + direction * way;
                let before = from.1.inverse() * (point - from.0);
                sum[0] += w - before.y / before.z;
                sum[1] += before.x / before.z - u;
                // Normalised by the picture of a pure rotation, as a calibration by rotation does.
                weight[0] += 1.0 + w * w;
                weight[1] += 1.0 + u * u;
                rays += 1.0;
            }
        }
        let half = f64::from(RAYS * RAYS) / 2.0;
        let flow = [sum[0] / weight[0], sum[1] / weight[1]];
        let fast = FASTEST * ms as f64 * 1e-3;
        (rays >= half && flow.iter().all(|f| f.abs() <= fast)).then_some(flow)
    }

    /// Range along the beam, m: the median of its rays.
    fn distance(&self, (from, attitude): (DVec3, DQuat)) -> Option<f64> {
        let side = libm::tan(HALF_BEAM);
        let mut found = [(0.0, 0.0), (side, 0.0), (-side, 0.0), (0.0, side), (0.0, -side)].map(|(u, w)| {
            self.pipe
                .or_ground_along(from, attitude * DVec3::new(u, w, 1.0))
                .unwrap_or(f64::INFINITY)
        });
        found.sort_by(f64::total_cmp);
        Some(found[2]).filter(|d| d.is_finite())
    }
}

fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}

/// Begin and end of the first gap after `ms`.
fn gap(rng: &mut Pcg64Mcg, ms: u64) -> (u64, u64) {
    let begins = ms + (rng.random_range(BETWEEN.0..BETWEEN.1) * 1e3) as u64;
    (begins, begins + (rng.random_range(GAP.0..GAP.1) * 1e3) as u64)
}

#[cfg(test)]
mod tests {
    use embassy_time::Instant;
    use sophie_control::calibration::flow::{FlowFit, FlowTurns, Round, flow_fit};
    use sophie_control::maths::vector::Quat;
    use sophie_control::navigation::flow_range_sample::GroundView;
    use sophie_control::params::{FlowMounting, Params};
    use sophie_drivers::ground_module::GroundModule;
    use sophie_drivers::msp::Parser;
    use sophie_ports::sensors::GroundDecoder;

    use super::*;

    const MOUNTED: DVec3 = DVec3::new(0.0, 0.0, 0.02);
    const PIPE: Pipe = Pipe {
        north: 3.0,
        half_length: 1.0,
        east: 0.0,
        down: -1.35,
        radius: 0.15,
        friction: 0.6,
    };

    /// Mean flow, rad/s, and range, m, in axes of the vehicle, of `seconds` of a motion.
    fn seen(seconds: u64, motion: impl Fn(f64) -> (DVec3, DQuat)) -> ([f64; 2], Option<f64>, usize) {
        seen_by(MOUNTED, seconds, motion)
    }

    fn seen_by(
        lens: DVec3,
        seconds: u64,
        motion: impl Fn(f64) -> (DVec3, DQuat),
    ) -> ([f64; 2], Option<f64>, usize) {
        let mut module = FlowModule::new(Streams::new(3), PIPE, lens);
        let (mut sum, mut ranges, mut flows, mut dark) = ([0.0; 2], vec![], 0, 0);
        for ms in 1..=seconds * 1000 {
            let (position, attitude) = motion(ms as f64 * 1e-3);
            module.step(&Pose {
                position,
                attitude,
                velocity: DVec3::ZERO,
                omega: DVec3::ZERO,
            });
            let mut parser = Parser::new();
            let bytes = module.take(ms * 1000).unwrap_or_default();
            for message in bytes.iter().filter_map(|byte| parser.take(*byte)) {
                match message {
                    Message::Flow { quality: 0, .. } => dark += 1,
                    Message::Flow { counts, .. } => {
                        flows += 1;
                        sum = std::array::from_fn(|i| sum[i] - f64::from(counts[i]) / COUNTS);
                    }
                    Message::Range { distance, .. } if distance < 0 => {}
                    Message::Range { distance, .. } => ranges.push(f64::from(distance) * 1e-3),
                }
            }
        }
        let time = f64::from(flows) * 1e-3 * PERIOD_MS as f64;
        let range = ranges.iter().sum::<f64>() / ranges.len() as f64;
        (
            sum.map(|angle| angle / time),
            (!ranges.is_empty()).then_some(range),
            dark,
        )
    }

    fn level(north: f64, height: f64) -> (DVec3, DQuat) {
        (DVec3::new(north, 0.0, -height), DQuat::IDENTITY)
    }

    fn near(a: f64, b: f64, within: f64) {
        assert!((a - b).abs() < within, "{a} {b}");
    }

    #[test]
    fn ground_and_turning_are_seen_by_the_standards_signs() {
        // 0.4 m/s forward and -0.2 to the right, 1 m over the ground: the picture pitches up and rolls right.
        let ([x, y], range, _) = seen(8, |t| {
            (
                DVec3::new(-8.0 + 0.4 * t, -0.2 * t, -1.0 - MOUNTED.z),
                DQuat::IDENTITY,
            )
        });
        // With a view this wide, calibrated by rotation, a translation reads short by tan²(21°) / 3 = 5 %.
        near(x, 0.2 / 1.05, 0.02);
        near(y, 0.4 / 1.05, 0.02);
        near(range.unwrap(), 1.0, 0.02);
        let ([x, y], ..) = seen(3, |t| {
            (DVec3::new(-8.0, 0.0, -1.0), DQuat::from_rotation_x(0.1 * t))
        });
        near(x, 0.1, 0.05);
        near(y, 0.0, 0.05);
    }

    /// Turning about the centre of mass moves a lens that is beside it: by its lever times the rate.
    #[test]
    fn a_lens_beside_the_centre_of_mass_measures_at_its_own_place() {
        let lens = DVec3::new(-0.2, 0.1, 0.05);
        let yawing = |t: f64| (DVec3::new(-8.0, 0.0, -1.05), DQuat::from_rotation_z(0.5 * t));
        // 0.5 rad/s clockwise: omega x r is (-0.05, -0.1, 0) m/s.
        let ([x, y], range, _) = seen_by(lens, 8, yawing);
        near(x, 0.1 / 1.05, 0.02);
        near(y, -0.05 / 1.05, 0.02);
        near(range.unwrap(), 1.0, 0.02);
        // Leaning by 0.2 rad to the right: 0.1 m to the right it is lower.
        let (_, range, _) = seen_by(lens, 1, |_| {
            (DVec3::new(-8.0, 0.0, -1.05), DQuat::from_rotation_x(0.2))
        });
        let (sin, cos) = libm::sincos(0.2f64);
        near(range.unwrap(), (1.05 - 0.05 * cos - 0.1 * sin) / cos, 0.02);
    }

    #[test]
    fn over_the_pipe_the_range_sees_it_and_the_flow_its_surroundings_too() {
        let ([_, y], range, _) = seen(4, |t| level(2.6 + 0.2 * t, 2.5));
        near(range.unwrap(), 1.0 - MOUNTED.z, 0.03);
        // Below the ground's rate and above the pipe's.
        assert!((0.2 / 2.5 * 1.1..0.2 * 0.9).contains(&y), "{y}");
        // Beyond the end the ground is back, out of the range's reach.
        let (_, range, _) = seen(2, |_| level(4.5, 2.6));
        assert_eq!(range, None);
    }

    #[test]
    fn near_the_ground_in_the_dark_and_too_fast_there_is_no_flow() {
        let (_, range, dark) = seen(1, |_| level(-8.0, 0.09));
        assert!(dark >= 45, "{dark}");
        near(range.unwrap(), 0.07, 0.02);
        let (.., dark) = seen(1, |t| level(-8.0 + 8.0 * t, 0.8));
        assert!(dark >= 45, "{dark}");
        // A gap within 40 s.
        let (.., dark) = seen(45, |_| level(-8.0, 1.0));
        assert!((15..200).contains(&dark), "{dark}");
    }

    /// A hundred frames a second, each of its own 10 ms, and ranges in whole centimetres: the driver sees the same motion.
    #[test]
    fn a_module_of_another_rate_and_step_sees_the_same_motion() {
        for (rate, step) in [(100.0, 0.01), (24.0, 0.001), (50.0, 0.02)] {
            let mut module = FlowModule::new(Streams::new(3), PIPE, MOUNTED).sending(Some(rate), Some(step));
            let mut driver = GroundModule::from_params(&Params::default());
            let (mut turned, mut seconds, mut frames) = (0.0, 0.0, 0);
            while module.ms < 8_000 {
                let t = module.ms as f64 * 1e-3;
                let position = DVec3::new(-8.0 + 0.5 * t, 0.0, -1.02);
                module.step(&Pose {
                    position,
                    attitude: DQuat::IDENTITY,
                    velocity: DVec3::ZERO,
                    omega: DVec3::ZERO,
                });
                let now = Instant::from_millis(module.ms);
                let Some(bytes) = module.take(module.ms * 1000) else {
                    continue;
                };
                let Some(view) = driver.take(&bytes, now) else {
                    continue;
                };
                frames += 1;
                let flow = view.flow.filter(|flow| flow.quality > 0);
                let (Some(flow), Some(distance)) = (flow, view.range.and_then(|range| range.distance)) else {
                    continue;
                };
                turned += f64::from(flow.angle[1]);
                seconds += f64::from(flow.seconds);
                let steps = f64::from(distance) / step;
                assert!((steps - steps.round()).abs() < 1e-3, "{rate}: {distance}");
            }
            let wanted = 8.0 * rate;
            assert!(
                (f64::from(frames) - wanted).abs() < 0.02 * wanted + 2.0,
                "{rate}: {frames}"
            );
            // 0.5 m/s at 1 m, seen by a view of 42 degrees.
            near(turned / seconds, 0.5 / 1.049, 0.04);
        }
    }

    /// Turned by hand about a point 10 cm over the lens, `height` m over the floor, through the driver with `p`.
    fn turned(module: &mut FlowModule, p: &Params, height: f64, far: bool) -> Round {
        let (mut driver, mut turns) = (GroundModule::from_params(p), FlowTurns::default());
        let mut view = GroundView::default();
        let begin = module.ms;
        while module.ms < begin + 9000 {
            let t = module.ms as f64 * 1e-3;
            let (roll, pitch) = (0.35 * libm::sin(3.5 * t), 0.35 * libm::sin(4.3 * t));
            let attitude = DQuat::from_rotation_y(pitch) * DQuat::from_rotation_x(roll);
            let pivot = DVec3::new(-8.0, 0.0, -height - 0.1);
            module.step(&Pose {
                position: pivot + attitude * (DVec3::new(0.0, 0.0, 0.1) - MOUNTED),
                attitude,
                velocity: DVec3::ZERO,
                omega: DVec3::ZERO,
            });
            let now = Instant::from_millis(module.ms);
            let bytes = module.take(module.ms * 1000).unwrap_or_default();
            view = driver.take(&bytes, now).unwrap_or(view);
            if module.ms.is_multiple_of(10) {
                let q = attitude.as_quat();
                let q = Quat {
                    w: q.w,
                    x: q.x,
                    y: q.y,
                    z: q.z,
                };
                turns.add(now.as_micros(), q, &view);
            }
        }
        turns.round(far).unwrap()
    }

    #[test]
    fn its_scale_and_mounting_are_found_through_the_driver_by_turning_it() {
        for seed in 1..=4 {
            let mut module = FlowModule::new(Streams::new(seed), PIPE, MOUNTED);
            let now = FlowFit {
                scale: 14.0,
                mounting: FlowMounting::Left,
            };
            let p = Params {
                flow_scale: now.scale,
                flow_mounting: now.mounting,
                ..Params::default()
            };
            let near = turned(&mut module, &p, 0.5, false);
            let far = turned(&mut module, &p, 1.5, true);
            let (fit, pivot) = flow_fit(&near, &far, now).unwrap();
            let off = fit.scale / (10.5 * module.scale as f32) - 1.0;
            println!("seed {seed}: scale off by {off:.3}, turned {pivot:.3} m over the lens");
            assert!(
                off.abs() < 0.02 && (pivot - 0.1).abs() < 0.03,
                "{seed}: {off} {pivot}"
            );
            assert_eq!(fit.mounting, FlowMounting::Forward);
        }
    }
}
