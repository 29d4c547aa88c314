//! Control law of the pilot: position to velocity to lean, height to climb rate to throttle, heading to yaw stick.
//!
//! Velocity crossover 0.38 Hz, 2.4 rad/s, below the 3 rad/s of people over a plant like 1/s² (McRuer and Krendel, AGARDograph 188,
//! 1974), lean at most 14°. Two trims take up the steady wind and the throttle of hover.

use glam::{DVec2, DVec3};
use sophie_control::params::Params;

use super::VisibleState;
use super::perception::Foresight;
use super::response::StickResponse;
use super::stick_dynamics::StickTarget;
use crate::plant::GRAVITY;
use crate::scenario::Scenario;

/// Distance to speed, 1/s.
const POSITION_GAIN: f64 = 1.0;
/// Fastest flight, m/s.
const SPEED_MAX: f64 = 1.2;
/// Speed error to acceleration, 1/s. The foresight feeds the acceleration back, which leaves 2.4 of it. With 8 and a position
/// gain of 1.3 he swings.
const SPEED_GAIN: f64 = 6.0;
/// Speed error to the wind trim, 1/s², and the distance within which it is learned, m.
const WIND_GAIN: f64 = 0.2;
const WIND_NEAR: f64 = 0.7;
/// Way that the vehicle makes towards a spot farther away, m, in a time, s. With less, the pilot learns the trim there too:
/// a strong wind holds it off before he has leaned enough.
const WAY: f64 = 0.3;
const WAY_TIME: f64 = 2.0;
/// Largest wind trim, m/s².
const WIND_MAX: f64 = 1.5;
/// Largest acceleration asked for, m/s² (14° of lean).
const ACCELERATION_MAX: f64 = 2.5;
/// Height error to climb rate, 1/s.
const HEIGHT_GAIN: f64 = 0.9;
/// Fastest climb and descent, m/s.
pub const CLIMB_MAX: f64 = 0.7;
/// See [`CLIMB_MAX`].
pub const DESCENT_MAX: f64 = 0.5;
/// Climb error to throttle, s/m; and to the hover trim, 1/m. These and the throttles below are those of the paper's
/// vehicle, which hovers at 53 %: see [`Guidance::strength`].
const CLIMB_GAIN: f64 = 0.09;
const HOVER_GAIN: f64 = 0.035;
/// Range of the hover trim.
const HOVER: (f64, f64) = (0.35, 0.75);
/// Throttle range used in the air.
const THROTTLE_MIN: f64 = 0.25;
const THROTTLE_MAX: f64 = 0.85;
/// Fastest motion of the throttle, 1/s.
const THROTTLE_SLEW: f64 = 0.8;
/// Heading error to yaw rate, 1/s.
const HEADING_GAIN: f64 = 0.4;

/// Target of the guidance.
#[derive(Clone, Copy, Debug)]
pub struct Course {
    /// North and east, m.
    pub target: DVec2,
    /// Height or climb rate.
    pub vertical: Vertical,
    /// Heading of the nose, rad.
    pub heading: f64,
    /// Rate of the heading, rad/s.
    pub turning: f64,
}

/// Vertical target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Vertical {
    /// Go to this height over the ground, m.
    Height(f64),
    /// Climb at this rate, m/s.
    Climb(f64),
}

/// The trained part of the pilot.
#[derive(Clone, Debug)]
pub struct Guidance {
    stick_angle: f64,
    stick_yaw_rate: f64,
    /// Throttle of hover as learned so far, 0..1.
    hover: f64,
    /// See [`Guidance::strength`].
    strength: f64,
    wind: DVec2,
    /// Distance from the spot when [`WAY_TIME`] last began, m, how long that is ago, s, and no way made before it.
    way: (f64, f64, bool),
    throttle: f64,
    /// Share of the gains for a vehicle that leans as slowly as this one: its foresight makes up for half of the lag.
    boldness: f64,
    foresight: Foresight,
    /// Predicted state at the time when the sticks act: position and velocity, NED.
    ahead: (DVec3, DVec3),
}

impl Guidance {
    /// A pilot who knows the weight, the stick travels and how the vehicle follows them.
    pub fn new(scenario: &Scenario) -> Self {
        let (params, response) = (&scenario.params, StickResponse::of(scenario));
        let hover = hover(params);
        Self {
            stick_angle: f64::from(params.stick_angle),
            stick_yaw_rate: f64::from(params.stick_yaw_rate),
            hover,
            strength: Self::strength_of(params),
            wind: DVec2::ZERO,
            way: (0.0, 0.0, false),
            throttle: 0.0,
            boldness: response.pace().sqrt(),
            foresight: Foresight::new(scenario.pilot.delay, response),
            ahead: Default::default(),
        }
    }

    /// The strength of a vehicle by its parameters.
    pub fn strength_of(params: &Params) -> f64 {
        hover(params) / hover(&Params::default())
    }

    /// Hover throttle over that of the paper's vehicle: below 1 with stronger rotors. The pilot scales every throttle
    /// and its rate by this factor, so that vehicles of any strength respond alike.
    pub fn strength(&self) -> f64 {
        self.strength
    }

    /// Position, m, and velocity, m/s, NED, that the vehicle will have when the sticks act.
    pub fn ahead(&self) -> (DVec3, DVec3) {
        self.ahead
    }

    /// The vehicle stands: another part sets the throttle, and no trim is learned.
    pub fn stand(&mut self, throttle: f64) {
        self.throttle = throttle;
        self.foresight.forget();
    }

    /// Updates the prediction from the stick positions (roll, pitch, yaw, throttle).
    pub fn foresee(&mut self, seen: &VisibleState, now: f64, sticks: [f64; 4], dt: f64) {
        let [roll, pitch, _, throttle] = sticks;
        let body = DVec2::new(
            -GRAVITY * libm::tan(pitch * self.stick_angle),
            GRAVITY * libm::tan(roll * self.stick_angle),
        );
        let horizontal = DVec2::from_angle(seen.yaw).rotate(body) - self.wind;
        let upright = libm::cos(roll * self.stick_angle) * libm::cos(pitch * self.stick_angle);
        let down = GRAVITY * (1.0 - throttle * upright / self.hover);
        self.foresight.note(now, horizontal, down, dt);
        self.ahead = self.foresight.ahead(seen, dt);
    }

    /// Steers along `course` for `dt` s.
    pub fn steer(&mut self, seen: &VisibleState, course: &Course, dt: f64) -> StickTarget {
        let (position, velocity) = self.ahead;
        let away = course.target - position.truncate();
        let speed = (away * (POSITION_GAIN * self.boldness)).clamp_length_max(SPEED_MAX);
        let error = speed - velocity.truncate();
        if self.learns(away.length(), dt) {
            self.wind = (self.wind + error * (WIND_GAIN * self.boldness * self.boldness * dt))
                .clamp_length_max(WIND_MAX);
        }
        let horizontal =
            (error * (SPEED_GAIN * self.boldness) + self.wind).clamp_length_max(ACCELERATION_MAX);
        let body = DVec2::from_angle(-seen.yaw).rotate(horizontal);
        let (pitch, roll) = (-libm::atan(body.x / GRAVITY), libm::atan(body.y / GRAVITY));
        StickTarget {
            roll: roll / self.stick_angle,
            pitch: pitch / self.stick_angle,
            yaw: self.rudder(seen, course.heading, course.turning),
            throttle: self.climb(course.vertical, libm::cos(roll) * libm::cos(pitch), dt),
            ..Default::default()
        }
    }

    /// Whether the speed error at the distance `away`, m, is that of the trim and not of the way.
    fn learns(&mut self, away: f64, dt: f64) -> bool {
        let (from, time, stands) = &mut self.way;
        if away < WIND_NEAR {
            (*time, *stands) = (0.0, false);
            return true;
        }
        if *time <= 0.0 {
            *from = away;
        }
        *time += dt;
        if *time > WAY_TIME {
            (*stands, *time) = (*from - away < WAY, 0.0);
        }
        *stands
    }

    /// Roll and pitch stick that hold the vehicle still in the air, against the wind and the error of the vehicle's
    /// level.
    pub fn trim(&self, seen: &VisibleState) -> (f64, f64) {
        let body = DVec2::from_angle(-seen.yaw).rotate(self.wind);
        let (roll, pitch) = (libm::atan(body.y / GRAVITY), -libm::atan(body.x / GRAVITY));
        (roll / self.stick_angle, pitch / self.stick_angle)
    }

    /// Throttle for `vertical` with a lean of cosine `upright`.
    pub fn climb(&mut self, vertical: Vertical, upright: f64, dt: f64) -> f64 {
        let (position, velocity) = self.ahead;
        let rate = match vertical {
            Vertical::Height(height) => (HEIGHT_GAIN * (height + position.z)).clamp(-DESCENT_MAX, CLIMB_MAX),
            Vertical::Climb(rate) => rate,
        };
        let error = rate + velocity.z;
        let s = self.strength;
        let (low, high) = HOVER;
        self.hover = (self.hover + HOVER_GAIN * s * error * dt).clamp(low * s, high * s);
        let goal = (self.hover + CLIMB_GAIN * s * error) / upright;
        let goal = goal.clamp(THROTTLE_MIN * s, THROTTLE_MAX * s).min(1.0);
        let step = THROTTLE_SLEW * s * dt;
        self.throttle += (goal - self.throttle).clamp(-step, step);
        self.throttle
    }

    /// Yaw stick that turns the nose to `heading`, which itself moves at `turning` rad/s.
    pub fn rudder(&self, seen: &VisibleState, heading: f64, turning: f64) -> f64 {
        ((HEADING_GAIN * super::wrap(heading - seen.yaw) + turning) / self.stick_yaw_rate).clamp(-1.0, 1.0)
    }
}

/// Throttle of hover by the parameters.
fn hover(params: &Params) -> f64 {
    f64::from(params.mass) * GRAVITY / (4.0 * f64::from(params.thrust_max))
}
