//! The spot on which the failsafe comes down where the position is known: straight below, or beside the pipe that is there.

use super::collective::HAND_OVER_TIME;
use super::descent::descent;
use crate::contact::contact_force::HINT_FORCE;
use crate::maths::scalar;
use crate::maths::vector::Vec3;
use crate::mode::context::{Context, Step};
use crate::mode::states::hold::{self, Place, felt};
use crate::mode::{Setpoint, State};
use crate::navigation::position_estimator::{Estimate, about_down};
use crate::pilot::rc::Sticks;
use crate::position_hold::{PositionHold, Wish};

/// Speed and climb of the way off the pipe, m/s, and its time with nothing that carries, s: with the stop 1 m, where the
/// largest pipe and the propellers' reach take 0.5 m.
const ASIDE_SPEED: f32 = 0.7;
const ASIDE_CLIMB: f32 = 0.3;
const ASIDE_TIME: f32 = 1.5;
/// Time after which it ends in any case, s.
const ASIDE_MAX: f32 = 4.0;

/// The way off the pipe.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Aside {
    /// Level, length 1, in the estimate's axes.
    direction: Vec3,
    /// With nothing that carries, and in all, s.
    left: f32,
    limit: f32,
}

/// Holds the vehicle over the spot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    place: Place,
    aside: Option<Aside>,
    wanted: Setpoint,
}

impl Spot {
    /// Below the vehicle, or beside the pipe if `from` was about to perch or to leave it; `None` without a fresh position,
    /// but what `from` holds is held on.
    pub fn under(from: &State, step: &mut Step<'_>) -> Option<Self> {
        let place = match from {
            State::Hold(hold) => hold.place,
            State::Approach(approach) => Place::new(approach.law),
            _ => return Self::from_here(Self::aside(from, step), step),
        };
        Some(Self::begin(place, Self::aside(from, step), step))
    }

    /// Below the vehicle; `None` without a fresh position.
    pub fn here(step: &mut Step<'_>) -> Option<Self> {
        Self::from_here(None, step)
    }

    fn from_here(aside: Option<Aside>, step: &mut Step<'_>) -> Option<Self> {
        let estimate = step.inputs.position.filter(|_| hold::fresh(step.inputs))?;
        let law = PositionHold::begin(&step.context.params, &estimate, &felt(step));
        Some(Self::begin(Place::new(law), aside, step))
    }

    fn begin(place: Place, aside: Option<Aside>, step: &mut Step<'_>) -> Self {
        let mut spot = Self {
            place,
            aside,
            wanted: Setpoint::Stop,
        };
        spot.step(None, step);
        spot
    }

    /// Away from the pipe, which lies along the nose unless the approach knows better.
    fn aside(from: &State, step: &Step<'_>) -> Option<Aside> {
        let (estimate, motion) = (step.inputs.position?, step.inputs.motion?);
        let nose = motion.q.to_euler().2 + estimate.turn;
        let right = about_down(Vec3::new(0.0, 1.0, 0.0), nose);
        let onwards = if right.dot(estimate.velocity) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let direction = match from {
            State::Approach(approach) => approach.off_pipe(estimate.position)?,
            State::Releasing(_) | State::Escaping(_) => right * onwards,
            _ => return None,
        };
        Some(Aside {
            direction,
            left: ASIDE_TIME,
            limit: ASIDE_MAX,
        })
    }

    /// One step, steered at the velocities that the sticks of the `pilot` ask for: where he steers, no way off is flown.
    pub fn step(&mut self, pilot: Option<Sticks>, step: &mut Step<'_>) {
        if pilot.is_some() {
            self.aside = None;
        }
        let estimate = step.inputs.position.unwrap_or_default();
        let wish = match self.way_off(&estimate, step) {
            Some(wish) => wish,
            None => hold::wished(&pilot.unwrap_or_default(), 0.0, step.context),
        };
        self.wanted = self.place.step(&estimate, &wish, step);
    }

    /// What the way off the pipe asks for, until it has ended.
    fn way_off(&mut self, estimate: &Estimate, step: &mut Step<'_>) -> Option<Wish> {
        let aside = self.aside.as_mut()?;
        let carried = step.context.support.resting();
        aside.left -= if carried { 0.0 } else { step.dt };
        aside.limit -= step.dt;
        if aside.left <= 0.0 || aside.limit <= 0.0 {
            self.aside = None;
            step.context.collective.hand_over(HAND_OVER_TIME);
            return None;
        }
        let nose = step.inputs.motion.map_or(0.0, |m| m.q.to_euler().2) + estimate.turn;
        let speed = if carried { 0.0 } else { ASIDE_SPEED };
        let level = about_down(aside.direction, -nose) * speed;
        Some(Wish {
            velocity: Vec3::new(level.x, level.y, -ASIDE_CLIMB),
            ..Wish::default()
        })
    }

    /// Over the spot and sinking; level where something seems to carry.
    pub fn rotors(&self, context: &Context) -> Setpoint {
        let sinking = descent(context, None);
        match self.wanted {
            wanted if self.aside.is_some() => wanted,
            Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                ..
            } if context.support.force() <= HINT_FORCE => Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                // The tilt takes lift away, as in a hold.
                thrust: sinking.thrust() / scalar::clamp(scalar::cos(roll) * scalar::cos(pitch), 0.5, 1.0),
            },
            _ => sinking,
        }
    }
}
