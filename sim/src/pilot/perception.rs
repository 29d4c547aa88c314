//! The pilot's delayed and noisy view.

use std::collections::VecDeque;

use glam::{DVec2, DVec3};
use rand::distr::Distribution;
use rand_pcg::Pcg64Mcg;

use super::VisibleState;
use super::response::StickResponse;
use crate::normal::StandardNormal;
use crate::streams::Streams;

/// Correlation time of the visual error, s (assumed).
const ERROR_TIME: f64 = 0.5;
/// Error of the seen velocity over that of the position, 1/s (assumed).
const VELOCITY_ERROR: f64 = 2.0;
/// RMS error of the seen heading, rad (assumed, 0.5°).
const YAW_ERROR: f64 = 0.009;

/// The pilot's view of the vehicle.
#[derive(Clone, Debug)]
pub struct Perception {
    delay: f64,
    noise: f64,
    rng: Pcg64Mcg,
    position_error: DVec3,
    velocity_error: DVec3,
    yaw_error: f64,
    queue: VecDeque<VisibleState>,
}

impl Perception {
    /// A view `delay` s late with an RMS error of `noise` m.
    pub fn new(delay: f64, noise: f64, streams: Streams) -> Self {
        Self {
            delay,
            noise,
            rng: streams.of("eyes"),
            position_error: DVec3::ZERO,
            velocity_error: DVec3::ZERO,
            yaw_error: 0.0,
            queue: VecDeque::new(),
        }
    }

    /// Takes the true state, `dt` s after the last one; returns the state as the pilot sees it.
    pub fn look(&mut self, now: VisibleState, dt: f64) -> VisibleState {
        let keep = (1.0 - dt / ERROR_TIME).max(0.0);
        let push = (1.0 - keep * keep).sqrt();
        let rng = &mut self.rng;
        let mut normal = || -> f64 { StandardNormal.sample(rng) };
        let mut vector = |rms: f64| DVec3::new(normal(), normal(), normal()) * rms;
        self.position_error = self.position_error * keep + vector(self.noise) * push;
        self.velocity_error = self.velocity_error * keep + vector(VELOCITY_ERROR * self.noise) * push;
        self.yaw_error = self.yaw_error * keep + vector(YAW_ERROR).x * push;
        self.queue.push_back(VisibleState {
            position: now.position + self.position_error,
            velocity: now.velocity + self.velocity_error,
            yaw: now.yaw + self.yaw_error,
            ..now
        });
        while self.queue.len() > 1 && self.queue[1].t <= now.t - self.delay {
            self.queue.pop_front();
        }
        self.queue[0]
    }
}

/// Predicts over the view's delay from the pilot's own sticks; without it a delay of 0.25 s prevents holding a spot to
/// centimetres.
#[derive(Clone, Debug)]
pub struct Foresight {
    delay: f64,
    response: StickResponse,
    /// Accelerations over the last `delay`: (time, north-east, down), m/s².
    past: VecDeque<(f64, DVec2, f64)>,
    /// Present acceleration, which follows the sticks with a lag.
    horizontal: DVec2,
    down: f64,
}

/// Prediction ahead of the present, s: lag of the sticks and half of the lean's, of the default loops and motors.
const AHEAD_HORIZONTAL: f64 = 0.25;
const AHEAD_DOWN: f64 = 0.12;

impl Foresight {
    /// Foresight over `delay` s of a vehicle with this `response`.
    pub fn new(delay: f64, response: StickResponse) -> Self {
        Self {
            delay,
            response,
            past: VecDeque::new(),
            horizontal: DVec2::ZERO,
            down: 0.0,
        }
    }

    /// Records the accelerations commanded by the sticks, m/s², without the trims against wind and weight.
    pub fn note(&mut self, t: f64, horizontal: DVec2, down: f64, dt: f64) {
        self.horizontal += (horizontal - self.horizontal) * (dt / (dt + self.response.lean_time));
        self.down += (down - self.down) * (dt / (dt + self.response.thrust_time));
        self.past.push_back((t, self.horizontal, self.down));
        while self.past.front().is_some_and(|p| p.0 <= t - self.delay) {
            self.past.pop_front();
        }
    }

    /// Clears the record: the vehicle stood, and the sticks did not move it.
    pub fn forget(&mut self) {
        *self = Self::new(self.delay, self.response);
    }

    /// Position and velocity, NED, predicted for when the sticks act.
    pub fn ahead(&self, seen: &VisibleState, dt: f64) -> (DVec3, DVec3) {
        let (mut position, mut velocity) = (seen.position, seen.velocity);
        for (_, horizontal, down) in &self.past {
            velocity += horizontal.extend(*down) * dt;
            position += velocity * dt;
        }
        // Constant velocity for the part of the delay without a record.
        position += velocity * (self.delay - self.past.len() as f64 * dt).max(0.0);
        let level = AHEAD_HORIZONTAL / self.response.pace();
        let down = AHEAD_DOWN + self.response.thrust_beyond();
        velocity += (self.horizontal * level).extend(self.down * down);
        (position, velocity)
    }
}
