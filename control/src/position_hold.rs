//! Position-hold controller, 100 Hz: sticks command velocities, centred sticks hold the position.
//!
//! Lateral: full state feedback, with the lag from setpoint to tilt in the state (docs/design/position-hold.md).
//! Vertical: a cascade with disturbance feed-forward. Without a position it stays level against the learnt wind, and
//! keeps the height by the inertial sensor for as long as the estimate's age allows.

pub mod gains;
mod height;
mod lag;
mod riccati;
#[cfg(test)]
mod tests;

use self::gains::Gains;
use self::height::Height;
use self::lag::Lag;
use crate::chain::setpoint::Setpoint;
use crate::maths::frames::about_down;
use crate::maths::scalar::{self, GRAVITY};
use crate::maths::vector::{Quat, Vec3};
use crate::navigation::estimate::Estimate;
use crate::params::Params;

/// Largest commanded velocity, horizontal and vertical, m/s.
pub const SPEED_MAX: f32 = 1.5;
/// See [`SPEED_MAX`].
pub const CLIMB_MAX: f32 = 0.7;
/// Slew limit of the commanded velocity, m/s².
const SPEED_SLEW: f32 = 1.0;
/// Largest acceleration asked for, the wind's included, m/s²: 17° of tilt, 5.4 N of wind.
pub const ACCELERATION_MAX: f32 = 3.0;
/// Time constant of each of the two stages of the held point's velocity, s, with loops at full pace: together they match
/// the lag from setpoint to tilt.
const COURSE_STAGE: f32 = 0.2;
/// Time constant of learning the wind, s.
const WIND_TIME: f32 = 4.0;
/// Departure of the disturbance from the wind beyond which it is contact, m/s²: gusts stay at a fifth.
const TOUCH: f32 = 1.5;
/// Largest distance of the held point from the vehicle, m: after a push the vehicle does not rush back.
const LEASH: f32 = 1.0;

/// Velocity command of the pilot or the approach.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct VelocityCommand {
    /// Forward, right and down along the heading, m/s: within [`SPEED_MAX`] and [`CLIMB_MAX`].
    pub velocity: Vec3,
    /// Clockwise from above, rad/s.
    pub yaw_rate: f32,
    /// Tilt command in use without a position, as acceleration forward and right, m/s².
    pub lean: [f32; 2],
}

/// Attitude, rate and support of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMotion {
    /// Body to world.
    pub q: Quat,
    /// Angular rate, rad/s, body.
    pub rate: Vec3,
    /// Contact carries the vehicle: the disturbance is not wind.
    pub carried: bool,
}

/// Reference model of the held point: the commanded velocity passes two stages that match the lag from tilt setpoint
/// to tilt. With a direct command the vehicle would overtake the point at each turn.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Course {
    /// Time constant of each stage, s.
    stage: f32,
    /// Commanded velocity within [`SPEED_SLEW`], the same behind one stage, and that of the held point, m/s.
    commanded: Vec3,
    between: Vec3,
    speed: Vec3,
    /// Their derivatives, m/s².
    asked: Vec3,
    turning: Vec3,
    gained: Vec3,
}

impl Course {
    /// At rest, with loops of the `pace`.
    fn at(pace: f32) -> Self {
        let rest = Vec3::ZERO;
        Self {
            stage: COURSE_STAGE / pace,
            commanded: rest,
            between: rest,
            speed: rest,
            asked: rest,
            turning: rest,
            gained: rest,
        }
    }

    fn step(&mut self, commanded: Vec3, dt: f32) {
        let slew = |from: f32, to: f32| scalar::slew(from, to, SPEED_SLEW * dt);
        let before = self.commanded;
        self.commanded = Vec3::new(
            slew(before.x, commanded.x),
            slew(before.y, commanded.y),
            slew(before.z, commanded.z),
        );
        let horizontal = |v: Vec3| Vec3::new(v.x, v.y, 0.0);
        let per_second = if dt > 0.0 { 1.0 / dt } else { 0.0 };
        self.asked = (self.commanded - before) * per_second;
        let per = 1.0 / (self.stage + dt);
        self.turning = horizontal(self.commanded - self.between) * per;
        self.between += self.turning * dt;
        self.gained = horizontal(self.between - self.speed) * per;
        self.speed += self.gained * dt;
        // The height loop has no such lag: it uses the commanded acceleration directly.
        self.speed.z = self.commanded.z;
    }

    /// Distance by which the held point is behind, m.
    fn behind(&self) -> Vec3 {
        let both = self.between + self.speed;
        Vec3::new(both.x, both.y, 0.0) * self.stage
    }
}

/// The controller and its state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PositionHold {
    mass: f32,
    gains: Gains,
    thrust: (f32, f32),
    lag: Lag,
    height: Height,
    /// Point to hold, m, and how it moves, in the estimate's axes.
    anchor: Vec3,
    course: Course,
    /// Learnt wind, m/s², in the estimate's axes.
    wind: Vec3,
    reset_count: u8,
}

impl PositionHold {
    /// A controller that holds the present position, with rotors of `full` thrust together, N.
    pub fn begin(p: &Params, gains: &Gains, full: f32, e: &Estimate, motion: &BodyMotion) -> Self {
        let weight = p.mass * GRAVITY;
        Self {
            mass: p.mass,
            gains: *gains,
            thrust: (0.4 * weight, scalar::clamp(1.6 * weight, weight, 0.95 * full)),
            lag: Lag::at(tilt(motion.q)),
            height: Height::default(),
            anchor: e.position,
            course: Course::at(gains.pace),
            wind: Vec3::new(e.disturbance.x, e.disturbance.y, 0.0),
            reset_count: e.reset_count,
        }
    }

    /// Goes on with other gains.
    pub fn change(&mut self, gains: &Gains) {
        self.gains = *gains;
    }

    /// Moves the held point to the present position; the learnt wind and trim stay.
    pub fn anchor_at(&mut self, e: &Estimate) {
        self.anchor = e.position;
        self.course = Course::at(self.gains.pace);
        self.reset_count = e.reset_count;
    }

    /// Place to which the commands so far lead the held point, m, in the estimate's axes; the point itself lags
    /// behind.
    pub fn held(&self) -> Vec3 {
        self.anchor + self.course.behind()
    }

    /// One step of `dt` s; unless the position is `known`, it is ignored and the sticks command the tilt.
    pub fn step(
        &mut self,
        e: &Estimate,
        motion: &BodyMotion,
        command: &VelocityCommand,
        known: bool,
        dt: f32,
    ) -> Setpoint {
        let heading = motion.q.to_euler().2 + e.yaw_offset;
        if e.reset_count != self.reset_count {
            self.anchor_at(e);
        }
        let commanded = about_down(command.velocity, heading);
        self.course.step(commanded, dt);
        let speed = self.course.speed;
        self.anchor += speed * dt;
        self.leash(e.position);
        let d = self.disturbance(e, motion.carried, dt);
        let ahead = |v: Vec3| {
            let v = about_down(v, -heading);
            [v.x, v.y]
        };
        let wind = ahead(self.wind);
        let u = if known {
            let (p, v) = (ahead(e.position - self.anchor), ahead(e.velocity - speed));
            let Course {
                asked,
                turning,
                gained,
                ..
            } = self.course;
            let course = [asked, turning, gained].map(ahead);
            self.feedback(p, v, ahead(d), wind, &course, motion)
        } else {
            core::array::from_fn(|i| at(&command.lean, i) - at(&wind, i))
        };
        let u = limited(u);
        self.lag
            .step(&self.gains.loops, u, tilt(motion.q), tilt_rate(motion.rate), dt);
        let up = self.height.step(
            &height::State {
                error: self.anchor.z - e.position.z,
                commanded: speed.z,
                gained: self.course.asked.z,
                velocity: e.velocity.z,
                disturbance: e.disturbance.z,
                landing: motion.carried && command.velocity.z > 0.0,
            },
            dt,
        );
        self.setpoint(u, up, motion.q, command.yaw_rate)
    }

    /// Limits the distance of the held point from the vehicle.
    fn leash(&mut self, position: Vec3) {
        let off = self.anchor - position;
        let horizontal = Vec3::new(off.x, off.y, 0.0);
        let over = scalar::clamp(LEASH * scalar::inv_sqrt(horizontal.norm_squared()), 0.0, 1.0);
        let horizontal = if horizontal.norm_squared() > LEASH * LEASH {
            horizontal * over
        } else {
            horizontal
        };
        let down = scalar::clamp_abs(off.z, height::LEASH);
        self.anchor = position + horizontal + Vec3::new(0.0, 0.0, down);
    }

    /// The lateral disturbance, from which the wind is learnt. In contact the learnt wind replaces it.
    fn disturbance(&mut self, e: &Estimate, carried: bool, dt: f32) -> Vec3 {
        let d = Vec3::new(e.disturbance.x, e.disturbance.y, 0.0);
        let off = d - self.wind;
        if carried || off.norm_squared() > TOUCH * TOUCH {
            return self.wind;
        }
        self.wind += off * (dt / (dt + WIND_TIME));
        d
    }

    /// Acceleration setpoint, forward and right, m/s². `course` has the reference's commanded acceleration, the part
    /// of it on its way to the tilt, and its present acceleration.
    fn feedback(
        &self,
        p: [f32; 2],
        v: [f32; 2],
        d: [f32; 2],
        wind: [f32; 2],
        course: &[[f32; 2]; 3],
        motion: &BodyMotion,
    ) -> [f32; 2] {
        let (a, rate) = (tilt(motion.q), tilt_rate(motion.rate));
        let Lag {
            first,
            second,
            turning,
            ..
        } = &self.lag;
        core::array::from_fn(|i| {
            let wind = at(&wind, i);
            let [asked, under_way, gained] = course.map(|course| at(&course, i));
            let state = [
                at(&p, i),
                at(&v, i),
                at(&a, i) + wind - gained,
                at(&rate, i),
                at(turning, i),
                at(second, i) + wind - under_way,
                at(first, i) + wind - under_way,
                at(&d, i) - wind,
            ];
            let fed: f32 = self.gains.state.iter().zip(state).map(|(k, x)| k * x).sum();
            asked - fed - wind
        })
    }

    fn setpoint(&self, u: [f32; 2], up: f32, q: Quat, yaw_rate: f32) -> Setpoint {
        let [forward, right] = u.map(|u| u * (1.0 / GRAVITY));
        let across = scalar::inv_sqrt(1.0 + right * right);
        let cos = scalar::clamp(q.down_in_body().z, 0.5, 1.0);
        let (least, most) = self.thrust;
        let thrust = self.mass * (GRAVITY + up) / cos;
        Setpoint::Angle {
            roll: arctangent(right),
            pitch: -arctangent(forward * across),
            yaw_rate,
            thrust: self.height.settled() * scalar::clamp(thrust, least, most),
        }
    }
}

/// Arctangent for |x| below 0.35, error below 1e-4: the error of the shared one would lean the vehicle by 0.1°.
fn arctangent(x: f32) -> f32 {
    let square = x * x;
    x * (1.0 - square * (1.0 / 3.0 - 0.2 * square))
}

/// Acceleration of the present tilt, forward and right, m/s².
fn tilt(q: Quat) -> [f32; 2] {
    let down = q.down_in_body();
    let per = GRAVITY / scalar::clamp(down.z, 0.5, 1.0);
    [per * down.x, per * down.y]
}

/// Rate of the tilt's acceleration, m/s³.
fn tilt_rate(rate: Vec3) -> [f32; 2] {
    [-GRAVITY * rate.y, GRAVITY * rate.x]
}

/// `u` limited to [`ACCELERATION_MAX`].
fn limited(u: [f32; 2]) -> [f32; 2] {
    let [x, y] = u;
    let square = x * x + y * y;
    if square > ACCELERATION_MAX * ACCELERATION_MAX {
        u.map(|u| u * ACCELERATION_MAX * scalar::inv_sqrt(square))
    } else {
        u
    }
}

fn at(values: &[f32; 2], axis: usize) -> f32 {
    values.get(axis).copied().unwrap_or(0.0)
}
