//! Rotors spool up again, then tendons pay out until every arm is proven free.

use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::clamp;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::mode::shared::on_pipe::{PipeAttitudeHold, SPOOL_TIME, held};
use crate::pilot::release_throttle::RELEASE_THROTTLE_MIN;

/// Time of free arms before flight, s.
pub const FREE_TIME: f32 = 0.3;
/// Time until arms that are not free are reported, s.
const STUCK_TIME: f32 = 10.0;

/// State of the mode [`crate::mode::Mode::Releasing`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Releasing {
    pub hold: PipeAttitudeHold,
    /// Reached share of the collective, 0..1.
    pub share: f32,
    pub free: f32,
    /// The tendons are paying out.
    pub opening: bool,
    /// Held by the gears: the drives start with the opening.
    pub kept: bool,
}

impl Releasing {
    /// Every chosen arm [holds](held).
    pub fn holds(&self, step: &Step<'_>) -> bool {
        held(step.inputs.grip, self.hold.arms, &step.context.params)
    }

    pub fn released(&self, step: &Step<'_>) -> bool {
        self.opening && step.arms_free()
    }

    /// The pilot turns the perch switch on again, or the radio is lost.
    pub fn called_back(step: &Step<'_>) -> bool {
        let seen_off = step.context.perch_switch.seen_off;
        step.inputs.sticks.is_none_or(|s| s.perch_switch && seen_off)
    }

    pub fn grounded(&self, step: &Step<'_>) -> bool {
        !self.opening && step.context.dangers.line_silent()
    }

    /// The lean has grown in spool-up: the arms stay closed.
    pub fn leans(&self, step: &Step<'_>) -> bool {
        !self.opening && self.spooled(step.dt) >= 1.0 && step.context.lean.too_far_to_release()
    }

    /// The rotors are up, and friction would not hold the vehicle while the arms open.
    pub fn lifts_off(&self, step: &Step<'_>) -> bool {
        // Tightened arms mean that friction is below its parameter.
        let slips = step.context.lean.lifts_off() || step.context.tightened > 0;
        !self.opening && self.spooled(step.dt) >= 1.0 && slips
    }

    /// Share of the collective after a step of `dt` s.
    pub fn spooled(&self, dt: f32) -> f32 {
        clamp(self.share + dt / SPOOL_TIME, 0.0, 1.0)
    }
}

impl Behaviour for Releasing {
    fn observe(&mut self, step: &mut Step<'_>) {
        self.free = if self.released(step) {
            self.free + step.dt
        } else {
            0.0
        };
    }

    fn advance(&mut self, step: &mut Step<'_>) {
        if step.context.since >= STUCK_TIME {
            step.context.note(Some(Reason::ArmsStuck));
        }
        self.hold = self.hold.levelled(step.dt);
        self.share = self.spooled(step.dt);
        self.opening |= self.share >= 1.0;
    }

    fn grip_memory(&self) -> GripMemory {
        if self.kept && !self.opening {
            GripMemory::HeldByGears(self.hold.arms)
        } else {
            GripMemory::Controlled(self.hold.arms)
        }
    }

    fn tendons(&self) -> ClampCommand {
        if self.opening {
            ClampCommand::Release
        } else if self.kept {
            ClampCommand::Keep
        } else {
            ClampCommand::Close { arms: self.hold.arms }
        }
    }

    fn rotors(&self, context: &Context, _: &Inputs) -> Setpoint {
        let asked = if context.auto_perch.active {
            RELEASE_THROTTLE_MIN
        } else {
            context.throttle
        };
        let throttle = clamp(asked, RELEASE_THROTTLE_MIN, context.params.perch_thr_max);
        self.hold.rotors(self.share * throttle * context.full_thrust())
    }
}
