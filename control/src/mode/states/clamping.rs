//! Closes the chosen arms under the pressure loop, then spools the rotors down once the grip is proven.

use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::clamp;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::mode::shared::on_pipe::{PipeAttitudeHold, SPOOL_DOWN_TIME, SPOOL_TIME, Spool, held, hopeless};

/// Time from the ramp's end until the rotors have stopped, s: six motor time constants.
pub const STOP_TIME: f32 = 0.3;
/// Time of an arm at its force limit, or faulty, that ends the closing, s.
pub const HOPELESS_TIME: f32 = 1.0;
/// The same for a pipe that lies across, s: waiting does not improve it, and on a flank the lean grows meanwhile.
const ACROSS_TIME: f32 = 0.1;

/// State of the mode [`crate::mode::Mode::Clamping`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamping {
    pub hold: PipeAttitudeHold,
    pub spool: Spool,
}

impl Clamping {
    /// Every chosen arm [holds](held).
    pub fn holds(&self, step: &Step<'_>) -> bool {
        held(step.inputs.grip, self.hold.arms, &step.context.params)
    }

    /// The grip is proven while the rotors may stop.
    fn proven(step: &Step<'_>) -> bool {
        step.grip_proven() && step.context.lean.may_stay()
    }

    /// Reason for which the rotors can never stop on these arms.
    fn hopeless(&self, step: &Step<'_>) -> Option<Reason> {
        if !step.grip_proven() {
            hopeless(step.inputs.grip, self.hold.arms)
        } else if !self.spool.down && !step.context.lean.may_stay() {
            Some(Reason::LeansToStay)
        } else {
            None
        }
    }

    /// Reason to end the closing. Without radio the pilot cannot fly away: then a poor grip is better than none.
    pub fn doubt(&self, step: &Step<'_>) -> Option<Reason> {
        let sticks = step.inputs.sticks?;
        let context = &step.context;
        let switched = !sticks.perch_switch && context.perch_switch.seen_on;
        if switched || context.auto_perch.taken {
            return Some(Reason::ClosingCancelled);
        }
        match self.hopeless(step) {
            Some(why @ Reason::PipeOblique) if self.spool.hopeless >= ACROSS_TIME => Some(why),
            Some(why) if self.spool.hopeless >= HOPELESS_TIME => Some(why),
            // Not while the rotors stop: these arms hold.
            _ if context.since >= context.params.clamp_timeout && !self.spool.down => {
                Some(Reason::GripNotProven)
            }
            _ => None,
        }
    }

    /// Reason to keep arms closed despite a doubt.
    pub fn must_stay(&self, step: &Step<'_>) -> Option<Reason> {
        if !self.holds(step) {
            None
        } else if step.context.lean.too_far_to_release() {
            // The belly would slide: a poor grip is better than none.
            Some(Reason::LeansTooFar)
        } else if step.context.dangers.line_silent() {
            // A vehicle that must not fly keeps its grip.
            Some(Reason::LINE_SILENT)
        } else {
            None
        }
    }

    /// Radio lost and battery critical: spools down slowly, without proof of grip.
    pub fn last_resort(step: &Step<'_>) -> bool {
        step.inputs.sticks.is_none() && step.context.dangers.battery_critical()
    }

    pub fn stands(&self, step: &Step<'_>) -> bool {
        self.spooled(step).still >= STOP_TIME
    }

    fn spooled(&self, step: &Step<'_>) -> Spool {
        let mut spool = self.spool;
        let down = if spool.down {
            self.holds(step)
        } else {
            Self::proven(step)
        };
        if down || Self::last_resort(step) {
            spool.down = true;
            spool.share = clamp(spool.share - step.dt / SPOOL_DOWN_TIME, 0.0, 1.0);
            spool.still = if spool.share <= 0.0 {
                spool.still + step.dt
            } else {
                0.0
            };
            spool
        } else {
            let share = clamp(spool.share + step.dt / SPOOL_TIME, 0.0, 1.0);
            Spool {
                hopeless: spool.hopeless,
                ..Spool::at(share)
            }
        }
    }
}

impl Behaviour for Clamping {
    fn observe(&mut self, step: &mut Step<'_>) {
        if step.inputs.sticks.is_none() {
            return;
        }
        self.spool.hopeless = if self.hopeless(step).is_some() {
            self.spool.hopeless + step.dt
        } else {
            0.0
        };
        if let (Some(_), Some(why)) = (self.doubt(step), self.must_stay(step)) {
            step.context.note(Some(why));
        }
    }

    fn advance(&mut self, step: &mut Step<'_>) {
        let spool = self.spooled(step);
        if self.spool.down && !spool.down {
            step.context.note(Some(Reason::GripLostSpooling));
        }
        self.spool = spool;
        self.hold = if spool.down {
            self.hold.following(step.inputs, step.dt)
        } else {
            self.hold.levelled(step.dt)
        };
    }

    fn grip_memory(&self) -> GripMemory {
        GripMemory::Controlled(self.hold.arms)
    }

    fn rotors(&self, context: &Context, _: &Inputs) -> Setpoint {
        if self.spool.stopped() {
            Setpoint::Stop
        } else {
            self.spool.rotors(self.hold, context.set_down_thrust())
        }
    }

    fn reason(&self, context: &Context, inputs: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        context.reason(inputs, true).or(context.crown_side())
    }
}
