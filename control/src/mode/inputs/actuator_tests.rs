//! Actuator tests: a builder orders them at the console; they begin and last in DISARMED alone.

use crate::allocation::motor_pulses::MotorPulses;
use crate::arming::ArmingInhibit;
use crate::chain::setpoint::Setpoint;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar;
use crate::maths::vector::Quat;
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::params::Params;
use crate::pilot::actuator_test::{
    ActuatorTest, ActuatorTestAnswer, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState,
};

/// Turn from the attitude at the start that ends a static thrust test, rad: what holds the vehicle gives by less, and one
/// rotor alone turns a loose vehicle by as much within 0.1 s.
pub const TURN_MAX: f32 = scalar::deg(15.0);

/// Conditions under which an actuator test may begin and continue.
#[derive(Clone, Copy, Debug)]
pub struct TestConditions {
    mode: Mode,
    grip_memory: GripMemory,
    arm_switch: bool,
    storing: bool,
    /// Fresh attitude, body to world: with it the motors' path runs.
    attitude: Option<Quat>,
    /// The battery is measured and not critical.
    battery: bool,
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
            attitude: inputs.motion.map(|motion| motion.q),
            battery: inputs
                .battery
                .is_some_and(|volts| volts >= params.battery_critical),
            pulses: MotorPulses::from_params(params).is_some(),
        }
    }

    /// Reason against `order`, the most basic first.
    fn refusal(&self, order: &ActuatorTest, said: Option<Propellers>) -> Option<ActuatorTestRefusal> {
        let tied = matches!(order, ActuatorTest::StaticThrust(_));
        let spins = matches!(order, ActuatorTest::Spin(_));
        let turns = spins || tied;
        let moves = turns || matches!(order, ActuatorTest::Place(_));
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
            (
                ActuatorTestRefusal::PropellersOn,
                spins && said != Some(Propellers::Off),
            ),
            (
                ActuatorTestRefusal::NotTiedDown,
                tied && said != Some(Propellers::OnAndTied),
            ),
            (ActuatorTestRefusal::ImuSilent, turns && self.attitude.is_none()),
            (ActuatorTestRefusal::MotorPulses, turns && !self.pulses),
            (ActuatorTestRefusal::BatteryCritical, tied && !self.battery),
            (ActuatorTestRefusal::OutOfRange, !order.is_allowed()),
        ];
        let ends = *order == ActuatorTest::End;
        reasons
            .into_iter()
            .find(|&(_, holds)| holds && !ends)
            .map(|(why, _)| why)
    }
}

/// What the builder has confirmed since power-up and since the vehicle was last armed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Propellers {
    /// They are off.
    Off,
    /// They are on, and the vehicle is tied down.
    OnAndTied,
}

/// An order that lasts.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Running {
    order: ActuatorTest,
    /// Time since its start, s.
    time: f32,
    /// Attitude at its start.
    from: Option<Quat>,
}

impl Running {
    /// The vehicle has turned by more than [`TURN_MAX`] since the start of a test that it is tied down for.
    fn turned(&self, now: Option<Quat>) -> bool {
        let (ActuatorTest::StaticThrust(_), Some(from), Some(now)) = (self.order, self.from, now) else {
            return false;
        };
        // The real part is the cosine of half the turn.
        (from.conjugate() * now).w.abs() < scalar::cos(0.5 * TURN_MAX)
    }
}

/// The actuator tests since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ActuatorTests {
    said: Option<Propellers>,
    answer: ActuatorTestAnswer,
    running: Option<Running>,
}

impl ActuatorTests {
    /// One step of `dt` s; `request` is `None` when the console has not renewed it.
    pub fn step(&mut self, request: Option<ActuatorTestRequest>, conditions: &TestConditions, dt: f32) {
        self.said = self
            .said
            .filter(|_| matches!(conditions.mode, Mode::Calibrating | Mode::Disarmed));
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
        self.answer.state = match (conditions.refusal(&order, self.said), order) {
            (Some(why), _) => ActuatorTestState::Refused(why),
            (None, ActuatorTest::End) => ActuatorTestState::Done,
            (None, ActuatorTest::PropellersOff) => {
                self.said = Some(Propellers::Off);
                ActuatorTestState::Done
            }
            (None, ActuatorTest::TiedDown) => {
                self.said = Some(Propellers::OnAndTied);
                ActuatorTestState::Done
            }
            (None, ActuatorTest::Spin(_) | ActuatorTest::Place(_) | ActuatorTest::StaticThrust(_)) => {
                self.running = Some(Running {
                    order,
                    time: 0.0,
                    from: conditions.attitude,
                });
                ActuatorTestState::Running
            }
        };
    }

    fn keep(&mut self, running: Running, conditions: &TestConditions, dt: f32) {
        let time = running.time + dt;
        if let Some(why) = conditions.refusal(&running.order, self.said) {
            self.finish(ActuatorTestState::Ended(why));
        } else if running.turned(conditions.attitude) {
            // What held the vehicle is looked at before the next test.
            self.said = None;
            self.finish(ActuatorTestState::Ended(ActuatorTestRefusal::Turned));
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

    /// What the rotors do for the running order.
    pub fn rotors(&self) -> Setpoint {
        match self.running {
            Some(Running {
                order: ActuatorTest::Spin(spin),
                ..
            }) => Setpoint::Spin(spin),
            Some(Running {
                order: ActuatorTest::StaticThrust(test),
                time,
                ..
            }) => Setpoint::StaticThrust(test.at(time)),
            _ => Setpoint::Stop,
        }
    }

    /// Reply to the newest order.
    pub fn answer(&self) -> ActuatorTestAnswer {
        self.answer
    }
}
