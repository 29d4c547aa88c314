//! A module of optical flow and range below the vehicle, of the MTF class: a PMW3901 and a time-of-flight sensor that
//! send MSP frames.
//!
//! | quantity | value | source |
//! |---|---|---|
//! | field of view, nearest, fastest | 42°, 8 cm, 7.4 rad/s | PMW3901's data sheet, the maker's table of the MTF-02 |
//! | range | 2 cm to 2.5 m, or as the scenario says | the same table; 8 m of the MTF-01 |
//! | counts | 10.5 a degree | INAV's default for a PMW3901 |
//! | noise, scale, delay, gaps | below | assumed, as in the feasibility study |

mod echo;
mod fault;
mod optics;
mod picture;
mod range_beam;
mod zero_motion;

use std::collections::VecDeque;

use crate::normal::StandardNormal;
use glam::{DQuat, DVec3};
use rand::Rng;
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;
use sophie_drivers::msp::Message;

pub use self::fault::FlowFault;
use self::fault::{Held, Reading};
pub use self::optics::{Look, Optics};
use self::picture::{COUNTS, Picture};
use crate::plant::contact::{Pipe, Pose};
use crate::streams::Streams;

/// Default time between two frames, ms: 50 a second.
const PERIOD_MS: u64 = 20;
/// Delay from the end of an interval, or from a range, to the last byte, µs: constant within these limits for a flight,
/// with this jitter for each frame.
const DELAY_US: (u64, u64) = (20_000, 30_000);
const JITTER_US: u64 = 1_500;
/// White noise of the flow of an interval, rad: 0.12 rad/s in 20 ms. An interval of 10 ms has nearly the same
/// (measured): a PMW3901 has 2.65 to 4.84 mrad in 20 ms and 2.5 to 4.1 mrad in 10 ms (recorded flights of a Crazyflie, Bitcraze's
/// positioning data set).
pub const FLOW_NOISE: f64 = 0.12 * 1e-3 * PERIOD_MS as f64;
/// Error of the flow's scale after calibration by rotation, RMS share.
const SCALE: f64 = 0.02;
/// Time between two pictures, ms.
const LOOK_MS: u64 = 4;
/// Nearest range, m.
const NEAREST: f64 = 0.02;
/// Farthest range indoors over a surface that scatters 90 % of the light, m.
pub const REACH: f64 = 2.5;
/// White noise of the range, m; error of its scale, RMS share.
const RANGE_NOISE: f64 = 0.015;
const RANGE_SCALE: f64 = 0.005;
/// Length of a gap without flow, s, and time between two gaps, s.
const GAP: (f64, f64) = (0.3, 1.0);
const BETWEEN: (f64, f64) = (10.0, 40.0);
/// Quality of a picture with enough texture.
const QUALITY: u8 = 120;

/// Errors of flow and range that a module of its kind has.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlowErrors {
    /// White noise of the flow of a frame, rad; `None`: [`FLOW_NOISE`].
    pub noise: Option<f64>,
    /// The quality varies whatever the flow is worth.
    pub quality_varies: bool,
    /// The range is a mean of all that its beam meets.
    pub mixed_pixels: bool,
    /// How far the range reaches, m; `None`: [`REACH`].
    pub reach: Option<f64>,
}

/// The module.
#[derive(Clone, Debug)]
pub struct FlowModule {
    rng: Pcg64Mcg,
    /// Of what light and texture do.
    optics_rng: Pcg64Mcg,
    pipe: Pipe,
    optics: Optics,
    /// The range is by [`echo`], not by geometry alone.
    echoes: bool,
    mixed_pixels: bool,
    reach: f64,
    flow_noise: f64,
    quality_varies: bool,
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
    /// Pictures of this interval, and the sum of their contrasts.
    pictures: (f64, f64),
    scale: f64,
    range_scale: f64,
    delay_us: u64,
    gap: (u64, u64),
    fault: FlowFault,
    failure: (u64, u64),
    held: Held,
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
            optics_rng: streams.of("flow.optics"),
            pipe,
            optics: Optics::default(),
            echoes: false,
            mixed_pixels: false,
            reach: REACH,
            flow_noise: FLOW_NOISE,
            quality_varies: false,
            lens,
            period_ms: PERIOD_MS,
            step_mm: 1.0,
            ms: 0,
            looked_ms: 0,
            before: None,
            angle: [0.0; 2],
            rest: [0.0; 2],
            seen: true,
            pictures: (0.0, 0.0),
            scale,
            range_scale,
            delay_us,
            gap,
            fault: FlowFault::Silent,
            failure: (0, 0),
            held: Held::default(),
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

    /// The same over surfaces that look as `optics` says, with the imperfections of `sensors`.
    #[must_use]
    pub fn looking(self, optics: Optics, errors: &FlowErrors) -> Self {
        Self {
            optics,
            echoes: optics.light.is_some() || optics.pipe.gloss > 0.0 || errors.mixed_pixels,
            mixed_pixels: errors.mixed_pixels,
            reach: errors.reach.unwrap_or(REACH),
            flow_noise: errors.noise.unwrap_or(FLOW_NOISE),
            quality_varies: errors.quality_varies,
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
            match picture::between(&self.pipe, &self.optics, before, now, since) {
                Some(Picture { flow, contrast }) => {
                    self.angle = [self.angle[0] + flow[0], self.angle[1] + flow[1]];
                    self.pictures = (self.pictures.0 + 1.0, self.pictures.1 + contrast);
                }
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
            let noisy = self.scale * angle + self.flow_noise * normal(&mut self.rng);
            // The picture moves against the vehicle.
            let whole = *rest - noisy * COUNTS;
            *count = whole.round() as i32;
            *rest = whole - whole.round();
        }
        let distance = self.distance(now);
        let noise = RANGE_NOISE * normal(&mut self.rng);
        let distance = distance.map(|d| (d * self.range_scale + noise) * 1e3);
        let mut quality = if seen && !dark { QUALITY } else { 0 };
        let jitter = self.rng.random_range(0..JITTER_US);
        if self.stands_still() {
            (counts, self.rest) = ([0; 2], [0.0; 2]);
        }
        if self.optics.light.is_some_and(|lux| lux < zero_motion::DARK) {
            quality = 0;
        }
        if quality > 0 && self.quality_varies {
            let (least, most) = zero_motion::QUALITIES;
            quality = self.optics_rng.random_range(least..=most);
        }
        let sound = Reading {
            quality,
            counts,
            distance,
        };
        let Some(Reading {
            quality,
            counts,
            distance,
        }) = self.held.spoilt(fault, self.ms, sound)
        else {
            return;
        };
        let flow = Message::Flow { quality, counts };
        let within = |d: &f64| (NEAREST * 1e3..=self.reach * 1e3).contains(d);
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

    /// Whether the flow of this interval reports no motion, whatever the vehicle does. Forgets its pictures.
    fn stands_still(&mut self) -> bool {
        let (pictures, contrast) = std::mem::take(&mut self.pictures);
        let Some(light) = self.optics.light else {
            return false;
        };
        let share = zero_motion::probability(contrast / f64::max(pictures, 1.0), light);
        self.optics_rng.random::<f64>() < share
    }

    /// Range along the beam, m, if the sensor has a return.
    fn distance(&mut self, now: (DVec3, DQuat)) -> Option<f64> {
        if !self.echoes {
            return range_beam::distance(&self.pipe, now);
        }
        let echo = echo::of(&self.pipe, &self.optics, now, self.mixed_pixels)?;
        let share = self.optics_rng.random::<f64>();
        (share < echo.probability(self.reach)).then_some(echo.range)
    }

    /// A range of `mm` rounded to the module's resolution, mm.
    fn in_steps(&self, mm: f64) -> f64 {
        if self.step_mm > 1.0 {
            (mm / self.step_mm).round() * self.step_mm
        } else {
            mm
        }
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
mod tests;
