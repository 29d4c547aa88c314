//! Autonomous departure from the pipe after an abandoned closing, a growing lean, or a release without support.
//!
//! The rotors lift more than the weight, nearly level, while the tendons pay out. A limited throttle, or the pilot's
//! throttle, set for resting, would let a sound vehicle fall: this state sets the collective until the throttle stick
//! reaches hover. If the stick never moves, the failsafe lands the vehicle.

use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::contact::contact_force::HINT_FORCE;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::{clamp, clamp_abs, deg};
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::mode::reason::Reason;
use crate::pilot::release_throttle::release_thrust;

/// Collective without climb, share of the weight: 3.4 m/s² upwards.
pub const LIFT_SHARE: f32 = 1.35;
/// Largest collective, share of the weight, for a sinking vehicle.
const MOST_SHARE: f32 = 1.7;
/// Least cosine of the tilt that the collective compensates.
const UPRIGHT_MIN: f32 = 0.7;
/// Least collective, share of the weight.
const LEAST_SHARE: f32 = 0.9;
/// Share of the weight per m/s of missing climb rate.
const CLIMB_GAIN: f32 = 0.7;
/// Climb rate until the vehicle is clear, m/s.
const CLIMB_RATE: f32 = 0.5;
/// Rise time of the collective on a slide, s: the lean grows e-fold in 0.16 s.
pub const SLIDE_RAMP: f32 = 0.05;
/// Delay for a standing vehicle, s, whose collective also rises more slowly: the rotors pull at the tendons with 7
/// times their thrust, so tendons at their limit must pay out first.
const STAND_DELAY: f32 = 0.25;
const STAND_RAMP: f32 = 0.5;
/// Longest wait for free arms while friction holds the vehicle, s: an arm bent round the pipe hooks it, and its rotor
/// turns the body. From 146° an arm is free after 1.2 s.
const STAND_MAX: f32 = 2.0;
/// Time after the rise until the vehicle is clear and the sticks steer, s.
const CLEAR_TIME: f32 = 0.65;
/// Time that the position may take to return after that, s; then control goes to the pilot. Optical flow works again
/// from 8 cm on.
const WAIT_TIME: f32 = 1.3;
/// Largest lean away from the pipe, rad: level rotors beside the crown pull the vehicle up along the flank, a lean
/// across the crown throws it under the pipe.
pub const AWAY_LEAN: f32 = deg(8.0);
/// Time for opening arms to come free, s. Rotors must not pull at stuck ones.
pub const FREE_MAX: f32 = 5.0;
/// Time for the pilot to take the throttle over, s.
pub const TAKE_OVER_TIME: f32 = 7.0;
/// Its stick thrust, share of the weight.
pub const TAKE_OVER_SHARE: f32 = 0.9;

/// State of the mode [`crate::mode::Mode::Escaping`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Escaping {
    grip_memory: GripMemory,
    /// Roll held until the vehicle is clear, rad.
    roll: f32,
    /// Collective at the start of the slow rise, N; `None` on a slide.
    from: Option<f32>,
    /// Time since the collective began to rise, s.
    rise: f32,
    /// Climb rate since the rise began, m/s; starts at the fall's speed.
    climb: f32,
    opening: bool,
}

impl Escaping {
    /// Leaves with the arms of `grip_memory`; the collective rises slowly from `from` N, or at once without it.
    pub fn leaving(inputs: &Inputs, grip_memory: GripMemory, from: Option<f32>) -> Self {
        let lean = inputs.motion.map_or(0.0, |m| m.q.to_euler().0);
        Self {
            grip_memory,
            roll: clamp_abs(lean, AWAY_LEAN),
            from,
            rise: 0.0,
            climb: 0.0,
            opening: grip_memory == GripMemory::Open,
        }
    }

    /// Arms that still hold after their time pull the vehicle down.
    pub fn stuck(&self, context: &Context) -> bool {
        self.late(context) && context.contact_force.force() < -HINT_FORCE
    }

    /// The arms are free, and the time to leave has passed. Unless an arm pulls it down, the vehicle flies whatever the
    /// arm's sensors read.
    pub fn clear(&self, context: &Context) -> bool {
        let free = self.grip_memory == GripMemory::Open || self.late(context);
        self.rise >= self.clear_after() && free
    }

    /// Duration of the rise until the vehicle is clear, s.
    fn clear_after(&self) -> f32 {
        self.from.map_or(SLIDE_RAMP, |_| STAND_RAMP) + CLEAR_TIME
    }

    /// The collective rises.
    fn rises(&self, context: &Context) -> bool {
        let holds = !context.lean.lifts_off() && context.tightened == 0;
        let waits = self.grip_memory != GripMemory::Open && holds;
        let until = if waits { STAND_MAX } else { STAND_DELAY };
        self.from.is_none() || context.since >= until
    }

    fn late(&self, context: &Context) -> bool {
        self.grip_memory.arms().is_some() && context.since >= FREE_MAX
    }
}

/// The throttle stick demands enough thrust to carry the vehicle.
pub fn takes_over(step: &Step<'_>) -> bool {
    let context = &step.context;
    step.inputs.sticks.is_some_and(|s| {
        context.full_thrust() * s.throttle >= TAKE_OVER_SHARE * context.contact_force.weight()
    })
}

impl Behaviour for Escaping {
    fn observe(&mut self, step: &mut Step<'_>) {
        let context = &step.context;
        if context.lean.slides() || context.lean.falls() {
            // Friction has ceased to hold the vehicle: the wait ends.
            self.from = None;
        }
        // Once begun, the rise does not stop.
        if self.rise > 0.0 || self.rises(context) {
            if self.rise <= 0.0 {
                // Only a fall sets a start value: an impact harder than predicted would look like a climb.
                self.climb = -clamp(context.fall.speed(), 0.0, 10.0);
            }
            self.rise = clamp(self.rise + step.dt, 0.0, 1e3);
            self.climb -= context.accel_down * step.dt;
        }
        // Below this collective only the arms keep the vehicle on the pipe.
        self.opening |= context.collective.now() >= release_thrust(&context.params);
        if self.opening && step.arms_free() {
            self.grip_memory = GripMemory::Open;
        }
    }

    fn advance(&mut self, step: &mut Step<'_>) {
        if self.late(step.context) {
            self.grip_memory = GripMemory::Open;
        }
    }

    fn grip_memory(&self) -> GripMemory {
        self.grip_memory
    }

    fn tendons(&self) -> ClampCommand {
        match self.grip_memory.arms() {
            Some(arms) if !self.opening => ClampCommand::Close { arms },
            _ => ClampCommand::Release,
        }
    }

    fn rotors(&self, context: &Context, inputs: &Inputs) -> Setpoint {
        let clear = self.clear(context);
        let wanted = if clear { 0.0 } else { CLIMB_RATE };
        let share = clamp(1.0 + CLIMB_GAIN * (wanted - self.climb), LEAST_SHARE, MOST_SHARE);
        // A tilted vehicle has less lift.
        let upright = inputs.motion.map_or(1.0, |m| m.q.down_in_body().z);
        let goal = share * context.contact_force.weight() / clamp(upright, UPRIGHT_MIN, 1.0);
        let thrust = self.from.map_or(goal, |from| {
            let risen = clamp(self.rise / STAND_RAMP, 0.0, 1.0);
            from + (goal - from) * risen
        });
        let steer = inputs.sticks.filter(|_| clear).unwrap_or_default();
        let params = &context.params;
        Setpoint::Escape {
            roll: if clear {
                steer.roll * params.stick_angle
            } else {
                self.roll
            },
            pitch: steer.pitch * params.stick_angle,
            yaw_rate: steer.yaw * params.stick_yaw_rate,
            thrust,
        }
    }

    fn reason(&self, context: &Context, inputs: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        let waits = self.rise >= self.clear_after() + WAIT_TIME && self.clear(context);
        let adrift = waits && context.auto_perch.acts() && !inputs.position_fresh();
        let lands = context.dangers.battery_critical() || inputs.sticks.is_none();
        if adrift && !lands {
            Some(Reason::PositionLost)
        } else {
            context.reason(inputs, true)
        }
    }

    fn hand_over_time(&self, _: Mode) -> f32 {
        SLIDE_RAMP
    }
}
