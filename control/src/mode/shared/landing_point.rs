//! The point on which the failsafe lands if the position is known: straight below, or beside a pipe below.

use super::coasting_hold::CoastingHold;
use super::collective::HAND_OVER_TIME;
use super::descent::descent;
use super::stick_velocity::velocity_from_sticks;
use crate::chain::setpoint::Setpoint;
use crate::contact::contact_force::HINT_FORCE;
use crate::maths::frames::about_down;
use crate::maths::scalar;
use crate::maths::vector::Vec3;
use crate::mode::context::{Context, Step};
use crate::navigation::estimate::Estimate;
use crate::pilot::rc::Sticks;
use crate::position_hold::{PositionHold, VelocityCommand};

/// Speed and climb of the sidestep off the pipe, m/s, and its time without support, s: with the stop 1 m, of which the
/// largest pipe and the propellers' reach take 0.5 m.
const ASIDE_SPEED: f32 = 0.7;
const ASIDE_CLIMB: f32 = 0.3;
const ASIDE_TIME: f32 = 1.5;
/// Longest duration of the sidestep, s.
const ASIDE_MAX: f32 = 4.0;

/// The sidestep off the pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Aside {
    /// Horizontal unit vector in the estimate's axes.
    direction: Vec3,
    /// Remaining time without support and remaining time in all, s.
    left: f32,
    limit: f32,
}

impl Aside {
    fn towards(direction: Vec3) -> Self {
        Self {
            direction,
            left: ASIDE_TIME,
            limit: ASIDE_MAX,
        }
    }
}

/// Horizontal unit vector to the side of the nose towards which the vehicle moves, in the estimate's axes.
fn sideways(step: &Step<'_>) -> Option<Vec3> {
    let (estimate, motion) = (step.inputs.position?, step.inputs.motion?);
    let nose = motion.q.to_euler().2 + estimate.yaw_offset;
    let right = about_down(Vec3::new(0.0, 1.0, 0.0), nose);
    let onwards = if right.dot(estimate.velocity) < 0.0 {
        -1.0
    } else {
        1.0
    };
    Some(right * onwards)
}

/// Holds the vehicle over the landing point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LandingPoint {
    hold: CoastingHold,
    aside: Option<Aside>,
    wanted: Setpoint,
}

impl LandingPoint {
    /// Lands at the point that `hold` holds.
    pub fn held(hold: CoastingHold, step: &mut Step<'_>) -> Self {
        Self::begin(hold, None, step)
    }

    /// Lands at the point that `position_hold` holds, or beside the pipe in the direction `off_pipe`, a horizontal unit vector in the
    /// estimate's axes.
    pub fn off_approach(position_hold: PositionHold, off_pipe: Option<Vec3>, step: &mut Step<'_>) -> Self {
        let aside = off_pipe
            .filter(|_| step.inputs.motion.is_some())
            .map(Aside::towards);
        Self::begin(CoastingHold::new(position_hold), aside, step)
    }

    /// Lands beside the pipe, which lies along the nose, on the side towards which the vehicle moves; `None` without a
    /// fresh position.
    pub fn beside_pipe(step: &mut Step<'_>) -> Option<Self> {
        let aside = sideways(step).map(Aside::towards);
        Self::from_here(aside, step)
    }

    /// Lands straight below; `None` without a fresh position.
    pub fn here(step: &mut Step<'_>) -> Option<Self> {
        Self::from_here(None, step)
    }

    fn from_here(aside: Option<Aside>, step: &mut Step<'_>) -> Option<Self> {
        let estimate = step.inputs.position.filter(|_| step.inputs.position_fresh())?;
        let position_hold = step.position_hold(&estimate);
        Some(Self::begin(CoastingHold::new(position_hold), aside, step))
    }

    fn begin(hold: CoastingHold, aside: Option<Aside>, step: &mut Step<'_>) -> Self {
        let mut landing = Self {
            hold,
            aside,
            wanted: Setpoint::Stop,
        };
        landing.step(None, step);
        landing
    }

    /// One step; the `pilot` commands velocities by his sticks, which cancels the sidestep.
    pub fn step(&mut self, pilot: Option<Sticks>, step: &mut Step<'_>) {
        if pilot.is_some() {
            self.aside = None;
        }
        let estimate = step.inputs.position.unwrap_or_default();
        let command = match self.way_off(&estimate, step) {
            Some(command) => command,
            None => velocity_from_sticks(&pilot.unwrap_or_default(), 0.0, step.context),
        };
        self.wanted = self.hold.step(&estimate, &command, step);
    }

    /// Velocity command of the sidestep, until it ends.
    fn way_off(&mut self, estimate: &Estimate, step: &mut Step<'_>) -> Option<VelocityCommand> {
        let aside = self.aside.as_mut()?;
        let carried = step.context.contact_force.resting();
        aside.left -= if carried { 0.0 } else { step.dt };
        aside.limit -= step.dt;
        if aside.left <= 0.0 || aside.limit <= 0.0 {
            self.aside = None;
            step.context.collective.hand_over(HAND_OVER_TIME);
            return None;
        }
        let nose = step.inputs.motion.map_or(0.0, |m| m.q.to_euler().2) + estimate.yaw_offset;
        let speed = if carried { 0.0 } else { ASIDE_SPEED };
        let sideways = about_down(aside.direction, -nose) * speed;
        Some(VelocityCommand {
            velocity: Vec3::new(sideways.x, sideways.y, -ASIDE_CLIMB),
            ..VelocityCommand::default()
        })
    }

    /// Sinks over the landing point; level when something seems to carry the vehicle.
    pub fn rotors(&self, context: &Context) -> Setpoint {
        let sinking = descent(context, None);
        match self.wanted {
            wanted if self.aside.is_some() => wanted,
            Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                ..
            } if context.contact_force.force() <= HINT_FORCE => Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                // A tilt reduces lift; compensated as in a hold.
                thrust: sinking.thrust() / scalar::clamp(scalar::cos(roll) * scalar::cos(pitch), 0.5, 1.0),
            },
            _ => sinking,
        }
    }
}
