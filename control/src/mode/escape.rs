//! Off the pipe by itself: what follows a closing that is given up, a lean that grows, a release that nothing carries.
//!
//! The rotors lift with more than the weight, nearly level, while the tendons pay out. A capped throttle would let a
//! vehicle with sound rotors fall, and so would the pilot's, which is set to rest on the pipe. So the collective stays
//! here until the throttle stick says hover; a pilot who never moves it is brought down by the failsafe.

use super::failsafe::Cause;
use super::logic::{ModeLogic, State};
use super::{Inputs, Reason, Setpoint};
use crate::grip_memory::GripMemory;
use crate::math::{clamp, clamp_abs, deg};
use crate::rc::Sticks;
use crate::support::HINT_FORCE;

/// Collective while the vehicle does not climb, share of the weight: 3.4 m/s² upwards.
const LIFT_SHARE: f32 = 1.35;
/// Least collective, share of the weight.
const LEAST_SHARE: f32 = 0.9;
/// Share of the weight for each m/s that the climb rate lacks.
const CLIMB_GAIN: f32 = 0.7;
/// Climb rate aimed at until the vehicle is clear, m/s; later the height is kept.
const CLIMB_RATE: f32 = 0.5;
/// Time over which the collective rises when the vehicle slides, s: its lean grows e-fold in 0.16 s.
pub(super) const SLIDE_RAMP: f32 = 0.15;
/// When it stands it rises later and slower, s: the rotors pull at the tendons with 7 times their thrust, and tendons at
/// their limit must have paid out before.
const STAND_DELAY: f32 = 0.25;
const STAND_RAMP: f32 = 0.5;
/// Time after the rise in which the vehicle comes clear of the pipe, s; the sticks do not steer before.
const CLEAR_TIME: f32 = 0.65;
/// Largest lean that is kept away from the pipe, rad: level rotors beside the crown pull the vehicle up along the flank,
/// and a lean across the crown throws it under the pipe.
const AWAY_LEAN: f32 = deg(8.0);
/// Time in which arms that open come free, s. Later ones are stuck on the pipe, and the rotors must not pull at them.
pub(super) const FREE_MAX: f32 = 5.0;
/// Time in which the pilot must have taken the throttle over, s.
pub(super) const TAKE_OVER_TIME: f32 = 7.0;
/// Thrust of the stick by which he takes it over, share of the weight.
pub(super) const TAKE_OVER_SHARE: f32 = 0.9;

/// Progress of an escape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escape {
    /// What the tendons still hold: open, or closed until every arm is proven free.
    pub grip_memory: GripMemory,
    /// Roll held until the vehicle is clear, rad.
    roll: f32,
    /// Collective from which the slow rise starts, N; `None` on a slide, which lifts at once.
    from: Option<f32>,
    /// Climb rate since the escape began, m/s.
    climb: f32,
    /// The tendons are paying out.
    pub opening: bool,
}

impl ModeLogic {
    /// Leaves the pipe from which the vehicle slides or falls, with the arms of `grip_memory` closed or closing.
    pub(super) fn slide_off(&mut self, i: &Inputs, grip_memory: GripMemory) -> State {
        self.leave(i, grip_memory, Reason::SlidesOff, None)
    }

    /// Leaves the pipe on which the vehicle stands, because its closing is given up for `why`.
    pub(super) fn give_up(&mut self, i: &Inputs, grip_memory: GripMemory, why: Reason) -> State {
        let from = self.collective.now().max(self.release_thrust());
        self.leave(i, grip_memory, why, Some(from))
    }

    fn leave(&mut self, i: &Inputs, grip_memory: GripMemory, why: Reason, from: Option<f32>) -> State {
        self.note(Some(why));
        self.perch_seen_off = false;
        let lean = i.motion.map_or(0.0, |m| m.q.to_euler().0);
        State::Escaping(Escape {
            grip_memory,
            roll: clamp_abs(lean, AWAY_LEAN),
            from,
            climb: 0.0,
            opening: grip_memory == GripMemory::Open,
        })
    }

    pub(super) fn escaping(&mut self, i: &Inputs, mut escape: Escape, dt: f32) -> State {
        escape.climb -= self.sinking * dt;
        // Below the least throttle of a release only the arms keep the vehicle on the pipe.
        escape.opening |= self.collective.now() >= self.release_thrust();
        if escape.opening && i.grip.is_some_and(|g| g.released) {
            escape.grip_memory = GripMemory::Open;
        }
        if let (Some(arms), true) = (escape.grip_memory.arms(), self.since >= FREE_MAX) {
            if self.support.force() < -HINT_FORCE {
                return self.stuck(i, arms);
            }
            // Nothing pulls the vehicle down: it flies, whatever an arm's sensors say.
            escape.grip_memory = GripMemory::Open;
        }
        if !self.clear(escape) {
            return State::Escaping(escape);
        }
        match (i.sticks, self.dangers.landing()) {
            (None, _) => State::Failsafe(Cause::RadioLost),
            (Some(_), Some(landing)) => State::Failsafe(landing),
            (Some(s), _) if self.takes_over(&s) => State::Flight,
            (Some(_), _) if self.since >= TAKE_OVER_TIME => State::Failsafe(Cause::NotTakenOver),
            (Some(_), _) => State::Escaping(escape),
        }
    }

    /// The arms are free, and there was time to leave the pipe.
    fn clear(&self, escape: Escape) -> bool {
        let ramp = escape.from.map_or(SLIDE_RAMP, |_| STAND_DELAY + STAND_RAMP);
        self.since >= ramp + CLEAR_TIME && escape.grip_memory == GripMemory::Open
    }

    /// The throttle stick carries the vehicle.
    pub(super) fn takes_over(&self, s: &Sticks) -> bool {
        4.0 * self.params.thrust_max * s.throttle >= TAKE_OVER_SHARE * self.support.weight()
    }

    /// Nearly level, climbing until the vehicle is clear; then where the pilot steers.
    pub(super) fn escape_rotors(&self, escape: Escape, sticks: Option<Sticks>) -> Setpoint {
        let clear = self.clear(escape);
        let wanted = if clear { 0.0 } else { CLIMB_RATE };
        let share = clamp(
            1.0 + CLIMB_GAIN * (wanted - escape.climb),
            LEAST_SHARE,
            LIFT_SHARE,
        );
        let goal = share * self.support.weight();
        let thrust = escape.from.map_or(goal, |from| {
            let risen = clamp((self.since - STAND_DELAY) / STAND_RAMP, 0.0, 1.0);
            from + (goal - from) * risen
        });
        let steer = sticks.filter(|_| clear).unwrap_or_default();
        Setpoint::Escape {
            roll: if clear {
                steer.roll * self.params.stick_angle
            } else {
                escape.roll
            },
            pitch: steer.pitch * self.params.stick_angle,
            yaw_rate: steer.yaw * self.params.stick_yaw_rate,
            thrust,
        }
    }
}
