//! What follows from a state: rotors, tendons, and the words for the pilot's display.

use super::closing::CLOSE_AGAIN;
use super::failsafe::Cause;
use super::logic::{ModeLogic, State};
use super::{ClampCommand, Inputs, Mode, Outputs, Reason, Setpoint, demand};
use crate::arming::{Checks, Refusal, Refusals};
use crate::grip_memory::GripMemory;
use crate::math::clamp;

impl ModeLogic {
    pub(super) fn refusals(&self, i: &Inputs) -> Refusals {
        let grip_memory = self.grip_memory();
        let chosen = grip_memory
            .arms()
            .unwrap_or(i.sticks.unwrap_or_default().arms)
            .mask();
        let held = grip_memory.arms().is_some() && self.grasps(i, grip_memory);
        let refusals = Checks {
            calibrated: i.motion.is_some_and(|m| m.calibrated),
            cos_tilt: i.motion.map(|m| m.q.down_in_body().z),
            sticks: i.sticks,
            switch_seen_off: self.arm_seen_off,
            battery: i.battery,
            fsr_fault: i
                .fsr_fault
                .iter()
                .zip(chosen)
                .any(|(&fault, chosen)| fault && chosen),
            late: i.late,
            hardware: i.hardware,
            arms_closed: grip_memory != GripMemory::Open && !held,
        }
        .refusals(&self.params);
        // The range of a sensor of an unused arm.
        let refusals = Refusal::FSR_RANGE
            .into_iter()
            .zip(chosen)
            .filter(|(_, chosen)| !chosen)
            .fold(refusals, |all, (range, _)| all.without(range));
        if grip_memory.arms().is_some() {
            // Armed on the pipe, the rotors stay stopped. There the switch is on, and turning it off is how the arms are
            // opened; and no one can reach the battery there to put a broken supply right.
            refusals
                .without(Refusal::PerchSwitchOn)
                .without(Refusal::BrownOut)
        } else {
            refusals
        }
    }

    /// The grip that must outlive a reset: from the first step of closing until every arm is proven free.
    fn grip_memory(&self) -> GripMemory {
        match self.state {
            State::Calibrating { grip_memory }
            | State::Disarmed { grip_memory }
            | State::Perched { grip_memory } => grip_memory,
            State::Releasing {
                hold,
                opening: false,
                kept: true,
                ..
            } => GripMemory::HeldByGears(hold.arms),
            State::Clamping { hold, .. } | State::Releasing { hold, .. } => GripMemory::Controlled(hold.arms),
            State::Escaping(escape) => escape.grip_memory,
            State::Armed | State::Flight | State::Contact { .. } | State::Landed | State::Failsafe(_) => {
                GripMemory::Open
            }
        }
    }

    pub(super) fn decide(&mut self, i: &Inputs, dt: f32) -> Outputs {
        let mode = self.state.mode();
        let grip_memory = self.grip_memory();
        let tendons = match (self.state, grip_memory) {
            (State::Releasing { opening: true, .. }, _) | (_, GripMemory::Open) => ClampCommand::Release,
            (State::Escaping(escape), _) if escape.opening => ClampCommand::Release,
            (_, GripMemory::Controlled(arms)) => ClampCommand::Close { arms },
            (_, GripMemory::HeldByGears(_) | GripMemory::Unknown) => ClampCommand::Keep,
        };
        self.probe(dt);
        let wish = self.wish(i);
        let rotors = self.collective.finish(wish, &self.params, dt);
        let grounded = matches!(mode, Mode::Calibrating | Mode::Disarmed);
        let refusals = if grounded {
            self.refusals(i)
        } else {
            Refusals::default()
        };
        let reason = self.reason(i, refusals);
        Outputs {
            mode,
            rotors,
            tendons,
            grip_memory,
            reason,
            refusals,
        }
    }

    /// Setpoint of the present state, before the collective is handed over and limited.
    fn wish(&self, i: &Inputs) -> Setpoint {
        let full = 4.0 * self.params.thrust_max;
        let perch_throttle = clamp(self.throttle, 0.0, self.params.perch_thr_max);
        match (self.state, i.sticks) {
            (State::Armed | State::Landed, _) => Setpoint::Idle,
            (State::Flight, Some(s)) => demand::from_sticks(&s, &self.params),
            // No transition leads here: without the radio it is the failsafe that flies.
            (State::Flight, None) => self.descent(Cause::RadioLost, None),
            (State::Contact { hold }, _) => hold.rotors(perch_throttle * full),
            (State::Clamping { spool, .. }, _) if spool.stopped() => Setpoint::Stop,
            (State::Clamping { hold, spool }, _) => spool.rotors(hold, perch_throttle * full),
            (State::Releasing { hold, share, .. }, _) => {
                let throttle = clamp(self.throttle, CLOSE_AGAIN, self.params.perch_thr_max);
                hold.rotors(share * throttle * full)
            }
            (State::Escaping(escape), sticks) => self.escape_rotors(escape, sticks),
            (State::Failsafe(cause), sticks) => self.descent(cause, sticks),
            (State::Calibrating { .. } | State::Disarmed { .. } | State::Perched { .. }, _) => Setpoint::Stop,
        }
    }

    fn reason(&self, i: &Inputs, refusals: Refusals) -> Option<Reason> {
        let note = self.note.0.filter(|_| self.note.1 > 0.0);
        match self.state {
            State::Calibrating { .. } if i.motion.is_none() => first(i.hardware.with(Refusal::ImuStale)),
            State::Calibrating { .. } if i.hardware.is_empty() => Some(Reason::KeepStill),
            // A builder must see what is broken without trying to arm.
            State::Calibrating { .. } => first(i.hardware),
            // What just happened comes before what keeps from arming again.
            State::Disarmed { .. } if note.is_none() && i.sticks.is_some_and(|s| s.arm_switch) => {
                first(refusals)
            }
            State::Disarmed { .. } if note.is_none() && !i.hardware.is_empty() => first(i.hardware),
            State::Perched { grip_memory } => self.perch_trouble(i, grip_memory).or(note),
            State::Failsafe(cause) => Some(cause.reason()),
            _ if self.dangers.battery_critical() => Some(Reason::BatteryCritical),
            _ if i.sticks.is_none() && self.state.mode() != Mode::Disarmed => Some(Reason::RADIO_LOST),
            _ if note.is_none() && self.dangers.line_silent() => Some(Reason::LINE_SILENT),
            _ => note,
        }
    }
}

fn first(refusals: Refusals) -> Option<Reason> {
    refusals.first().map(Reason::Check)
}
