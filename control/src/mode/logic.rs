//! The state machine, stepped at 100 Hz.

use super::context::{Context, Step};
use super::inputs::Inputs;
use super::inputs::actuator_tests::TestConditions;
use super::modes::Mode;
use super::outputs::Outputs;
use super::remote_refusal;
use super::state::State;
use super::states::calibrating::Calibrating;
use super::table::transitions::Transition;
use crate::arming::ArmingInhibits;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::clamp;
use crate::params::Params;
use crate::pilot::remote::{RemoteOrder, RemoteRefusal, RemoteRequest};
use crate::position_hold::gains::HoldGains;
use crate::thrust_factor::Air;

/// Longest step accepted, s: a stall of the commander must not end a timer.
const STEP_MAX: f32 = 0.05;

/// The mode logic of one vehicle.
#[derive(Clone, Debug)]
pub struct ModeLogic {
    context: Context,
    state: State,
}

impl ModeLogic {
    /// A vehicle just powered up: it first checks whether its arms are closed.
    pub fn new(params: &Params) -> Self {
        Self::resume(params, &HoldGains::of(params), GripMemory::Unknown, None)
    }

    /// A vehicle restarted with this grip and the thrust factor that it had learnt, and the gains for its parameters. The
    /// rotors wait for the pilot in either case.
    pub fn resume(
        params: &Params,
        hold_gains: &HoldGains,
        grip_memory: GripMemory,
        thrust_factor: Option<f32>,
    ) -> Self {
        Self {
            context: Context::new(params, hold_gains, thrust_factor),
            state: State::Calibrating(Calibrating { grip_memory }),
        }
    }

    #[cfg(test)]
    pub(super) fn state(&self) -> &State {
        &self.state
    }

    #[cfg(test)]
    pub(super) fn forget_thrust(&mut self) {
        self.context.thrust.forget();
    }

    /// One step, `dt` s after the last.
    pub fn step(&mut self, inputs: &Inputs, dt: f32) -> Outputs {
        let dt = clamp(dt, 0.0, STEP_MAX);
        let (inputs, before) = (inputs.finite(), self.state.mode());
        let dropped = self
            .context
            .remote
            .follow(&inputs, before, self.state.behaviour().grip_memory(), dt);
        self.context.perch_switch.forget(dropped);
        let remote = self.context.remote.take(inputs.remote);
        let refused = remote.and_then(|request| self.weigh(request.order, &inputs, dt));
        let inputs = &self.context.remote.apply(inputs);
        self.context.observe(inputs, air(before), dt);
        let conditions = TestConditions::new(
            before,
            self.state.behaviour().grip_memory(),
            inputs,
            &self.context.params,
        );
        self.context
            .actuator_tests
            .step(inputs.actuator_test, &conditions, dt);
        if let (Some(request), None) = (remote, refused) {
            self.context.obey(request.order);
        }
        let step = &mut Step {
            context: &mut self.context,
            inputs,
            dt,
        };
        step.context.auto_perch.follow(before, inputs);
        self.state.behaviour_mut().observe(step);
        match Transition::first(&self.state, step) {
            Some(transition) => {
                self.state = transition.enter(&self.state, step);
                if self.state.mode() != before {
                    self.context.since = 0.0;
                    self.context.auto_perch.enters(self.state.mode());
                    let auto_perch = self.context.auto_perch.active;
                    let dropped = self.context.remote.enters(self.state.mode(), auto_perch);
                    self.context.perch_switch.forget(dropped);
                    let time = self.state.behaviour().hand_over_time(before);
                    self.context.collective.hand_over(time);
                }
            }
            None => self.state.behaviour_mut().advance(step),
        }
        if let Some(RemoteRequest { number, order }) = remote {
            let refusal = refused.or_else(|| remote_refusal::outcome(order, self.state.mode()));
            if refusal.is_some() && refused.is_none() {
                self.context.remote.turn_back(order);
            }
            self.context.remote.reply(number, refusal);
        }
        self.decide(inputs, dt)
    }

    /// Reason against `order`; without one, turns the perch switch.
    fn weigh(&mut self, order: RemoteOrder, inputs: &Inputs, dt: f32) -> Option<RemoteRefusal> {
        let inputs = &self.context.remote.apply(*inputs);
        let step = &Step {
            context: &mut self.context,
            inputs,
            dt,
        };
        let refusal = remote_refusal::refusal(order, &self.state, step);
        if refusal.is_none() {
            self.context.remote.turn(order);
        }
        refusal
    }

    fn decide(&mut self, inputs: &Inputs, dt: f32) -> Outputs {
        let (mode, state, context) = (self.state.mode(), self.state.behaviour(), &mut self.context);
        context
            .ground_probe
            .step(mode == Mode::Failsafe, &context.contact_force, dt);
        let setpoint = state.rotors(context, inputs);
        let full = context.full_thrust();
        let rotors = context.collective.finish(setpoint, full, dt);
        let grip_memory = state.grip_memory();
        let inhibits = if rotors_locked(mode) {
            context.inhibits(inputs, grip_memory)
        } else {
            ArmingInhibits::NONE
        };
        Outputs {
            mode,
            rotors,
            tendons: context.tight(state.tendons()),
            grip_memory,
            reason: state.reason(context, inputs, inhibits),
            inhibits,
            actuator_test: context.actuator_tests.answer(),
            remote: context.remote.answer(),
            gentle: context.has_swung,
            thrust_factor: context.thrust.now(),
        }
    }
}

fn air(mode: Mode) -> Air {
    match mode {
        _ if rotors_locked(mode) => Air::Locked,
        Mode::Flight | Mode::Hold => Air::Free,
        _ => Air::Near,
    }
}

fn rotors_locked(mode: Mode) -> bool {
    matches!(mode, Mode::Calibrating | Mode::Disarmed)
}
