//! Actuator tests: a builder orders them at the console; they begin and last in DISARMED alone.

use crate::allocation::motor_pulses::MotorPulses;
use crate::arming::ArmingInhibit;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::params::Params;
use crate::pilot::actuator_test::{
    ActuatorTest, ActuatorTestAnswer, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState,
};

/// Conditions under which an actuator test may begin and continue.
#[derive(Clone, Copy, Debug)]
pub struct TestConditions {
    mode: Mode,
    grip_memory: GripMemory,
    arm_switch: bool,
    storing: bool,
    /// The attitude is fresh: the motors' path runs.
    motion: bool,
    /// The motor pulses are in rising order.
    pulses: bool,
}

impl TestConditions {
    pub fn new(mode: Mode, grip_memory: GripMemory, inputs: &Inputs, params: &Params) -> Self {
        Self {
            mode,
            grip_memory,
            arm_switch: inputs.sticks.is_some_and(|s| s.arm_switch),
            storing: inputs.hardware.contains(ArmingInhibit::Storing),
            motion: inputs.motion.is_some(),
            pulses: MotorPulses::from_params(params).is_some(),
        }
    }

    /// Reason against `order`, the most basic first.
    fn refusal(&self, order: &ActuatorTest, propellers_off: bool) -> Option<ActuatorTestRefusal> {
        let spins = matches!(order, ActuatorTest::Spin(_));
        let moves = spins || matches!(order, ActuatorTest::Place(_));
        let reasons = [
            (ActuatorTestRefusal::NotDisarmed, self.mode != Mode::Disarmed),
            (ActuatorTestRefusal::ArmSwitchOn, self.arm_switch),
            (ActuatorTestRefusal::Storing, self.storing),
            (
                ActuatorTestRefusal::GripUnknown,
                moves && self.grip_memory == GripMemory::Unknown,
            ),
            (
                ActuatorTestRefusal::ArmsClosed,
                moves && self.grip_memory.arms().is_some(),
            ),
            (ActuatorTestRefusal::PropellersOn, spins && !propellers_off),
            (ActuatorTestRefusal::ImuSilent, spins && !self.motion),
            (ActuatorTestRefusal::MotorPulses, spins && !self.pulses),
            (ActuatorTestRefusal::OutOfRange, !order.is_allowed()),
        ];
        let ends = *order == ActuatorTest::End;
        reasons
            .into_iter()
            .find(|&(_, holds)| holds && !ends)
            .map(|(why, _)| why)
    }
}

/// An order that lasts, with its remaining time, s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Running {
    order: ActuatorTest,
    time: f32,
}

/// The actuator tests since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActuatorTests {
    /// Confirmed since power-up and since the vehicle was last armed.
    propellers_off: bool,
    answer: ActuatorTestAnswer,
    running: Option<Running>,
}

impl ActuatorTests {
    /// One step of `dt` s; `request` is `None` when the console has not renewed it.
    pub fn step(&mut self, request: Option<ActuatorTestRequest>, conditions: &TestConditions, dt: f32) {
        self.propellers_off &= matches!(conditions.mode, Mode::Calibrating | Mode::Disarmed);
        match (request, self.running) {
            (Some(request), _) if request.number != self.answer.number => self.begin(request, conditions),
            (Some(_), Some(running)) => self.keep(running, conditions, dt),
            (None, Some(_)) => self.finish(ActuatorTestState::Ended(ActuatorTestRefusal::NotRenewed)),
            (_, None) => (),
        }
    }

    fn begin(
        &mut self,
        ActuatorTestRequest { number, order }: ActuatorTestRequest,
        conditions: &TestConditions,
    ) {
        self.answer.number = number;
        self.running = None;
        self.answer.state = match (conditions.refusal(&order, self.propellers_off), order) {
            (Some(why), _) => ActuatorTestState::Refused(why),
            (None, ActuatorTest::End) => ActuatorTestState::Done,
            (None, ActuatorTest::PropellersOff) => {
                self.propellers_off = true;
                ActuatorTestState::Done
            }
            (None, ActuatorTest::Spin(_) | ActuatorTest::Place(_)) => {
                self.running = Some(Running { order, time: 0.0 });
                ActuatorTestState::Running
            }
        };
    }

    fn keep(&mut self, running: Running, conditions: &TestConditions, dt: f32) {
        let time = running.time + dt;
        if let Some(why) = conditions.refusal(&running.order, self.propellers_off) {
            self.finish(ActuatorTestState::Ended(why));
        } else if time < running.order.longest() {
            self.running = Some(Running { time, ..running });
        } else {
            self.finish(ActuatorTestState::Done);
        }
    }

    /// Ends the running order: someone disarms.
    pub fn stop(&mut self) {
        if self.running.is_some() {
            self.finish(ActuatorTestState::Ended(ActuatorTestRefusal::Disarm));
        }
    }

    fn finish(&mut self, state: ActuatorTestState) {
        self.running = None;
        self.answer.state = state;
    }

    /// The running order.
    pub fn order(&self) -> Option<ActuatorTest> {
        self.running.map(|running| running.order)
    }

    /// Reply to the newest order.
    pub fn answer(&self) -> ActuatorTestAnswer {
        self.answer
    }
}
