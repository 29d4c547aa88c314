//! Orders to the commander: arming, gripper and actuator tests. Each is acknowledged when the commander has answered.

use sophie_control::pilot::actuator_test::{
    ActuatorTest, ActuatorTestRefusal, ActuatorTestRequest, ActuatorTestState, PLACE_TIME, Place, SPIN_TIME,
    Spin,
};
use sophie_control::pilot::remote::{RemoteOrder, RemoteRefusal, RemoteRequest};
use sophie_control::pilot::static_thrust_test::{PLATEAU, Rotors, STEP_PLATEAU, StaticThrustTest};

use sophie_control::calibration::procedure::Procedure;

use super::{Received, or_zero, whole};
use crate::services::Services;
use crate::vehicle::Vehicle;
use crate::wire::requests::Peer;
use sophie_dialect::*;

/// Longest time to the commander's answer, µs: fifty of its periods.
const COMMANDER: u64 = 500_000;
/// Longest time between two commands of one static thrust test, µs: whoever has ordered it is still there.
const RENEWAL: u64 = 1_500_000;
/// Time that the commander has to end a static thrust test after its own time, s.
const MARGIN: f32 = 0.5;
/// The standard's number for disarming in flight.
const FORCED: u32 = 21_196;
/// Number of the first tendon servo among the outputs, as in SERVO_OUTPUT_RAW.
const FIRST_SERVO: u32 = 5;

/// The requests to the commander. Each is sent at every run until it is answered or withdrawn.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CommanderRequests {
    /// Arming and gripper.
    pub remote: Option<RemoteRequest>,
    /// Actuator tests.
    pub actuator_test: Option<ActuatorTestRequest>,
}

/// The part of the server that acknowledges a waiting command. What another part ends does not acknowledge it: a motor
/// test lasts longer than its command waits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Answerer {
    /// Arming and gripper, by the commander.
    Remote,
    /// Actuator tests, by the commander.
    ActuatorTest,
    /// The procedure of calibrations.
    Calibration,
    /// The board: rows of a report, brown-out level.
    Board,
}

/// A command whose answer comes later.
#[derive(Clone, Copy, Debug)]
struct Pending {
    command: u16,
    by: Answerer,
    to: Peer,
    since: u64,
}

/// An actuator test.
#[derive(Clone, Copy, Debug)]
struct Trial {
    /// The number is 0 before it is sent.
    request: ActuatorTestRequest,
    /// Its end, µs.
    until: u64,
    /// Of a static thrust test: its run, and the time of its newest command, µs.
    renewed: Option<(u32, u64)>,
}

impl Trial {
    /// A test that begins at `now`, µs, and lasts `seconds` at most.
    fn new(order: ActuatorTest, now: u64, seconds: f32) -> Self {
        Self {
            request: ActuatorTestRequest { number: 0, order },
            until: now.saturating_add((seconds * 1e6) as u64),
            renewed: None,
        }
    }

    /// True if it is over at `now`, µs: by its time, or because its sender is silent.
    fn is_over(&self, now: u64) -> bool {
        now >= self.until || self.is_abandoned(now)
    }

    /// True if its sender should have renewed it by `now`, µs.
    fn is_abandoned(&self, now: u64) -> bool {
        self.renewed
            .is_some_and(|(_, heard)| now.saturating_sub(heard) > RENEWAL)
    }
}

/// The orders of one line.
#[derive(Debug)]
pub struct Orders {
    pending: Option<Pending>,
    /// The number is 0 before it is sent.
    remote: Option<RemoteRequest>,
    trial: Option<Trial>,
    /// Number of this line's newest actuator test.
    own: u32,
    /// Newest run of a static thrust test; 0 before the first.
    run: u32,
}

impl Orders {
    pub const fn new() -> Self {
        Self {
            pending: None,
            remote: None,
            trial: None,
            own: 0,
            run: 0,
        }
    }
}

impl Services {
    /// Gives the order that the command asks for; `None` if the acknowledgement comes later.
    pub(super) fn order_by(
        &mut self,
        received: &Received<'_>,
        procedure: &mut Procedure,
    ) -> Option<MavResult> {
        let number = u32::from(received.command.number);
        if number == MavCmd::MAV_CMD_COMPONENT_ARM_DISARM as u32 {
            self.arm_disarm(received, procedure)
        } else if number == MavCmd::MAV_CMD_DO_GRIPPER as u32 {
            self.gripper(received, procedure)
        } else if number == MavCmd::MAV_CMD_DO_MOTOR_TEST as u32 {
            self.motor_test(received)
        } else if number == MavCmd::MAV_CMD_SOPHIE_STATIC_THRUST as u32 {
            self.static_thrust(received)
        } else if number == MavCmd::MAV_CMD_DO_SET_SERVO as u32 {
            self.set_servo(received)
        } else if number == MavCmd::MAV_CMD_USER_1 as u32 {
            let [first, ..] = received.command.params;
            let order = match whole(first) {
                Some(1) => ActuatorTest::PropellersOff,
                Some(2) => ActuatorTest::TiedDown,
                _ => return Some(self.deny("1 propellers off, 2 on and tied down")),
            };
            self.try_actuator(received, Trial::new(order, received.now, 0.0))
        } else {
            Some(MavResult::MAV_RESULT_UNSUPPORTED)
        }
    }

    fn arm_disarm(&mut self, received: &Received<'_>, procedure: &mut Procedure) -> Option<MavResult> {
        let [what, force, ..] = received.command.params;
        let order = match (whole(what), whole(or_zero(force)) == Some(FORCED)) {
            (Some(1), false) => RemoteOrder::Arm,
            (Some(1), true) => return Some(self.deny("no arming check can be forced")),
            (Some(0), false) => RemoteOrder::Disarm,
            (Some(0), true) => RemoteOrder::Kill,
            _ => return Some(self.deny("0 disarms, 1 arms")),
        };
        self.give(received, order, procedure)
    }

    fn gripper(&mut self, received: &Received<'_>, procedure: &mut Procedure) -> Option<MavResult> {
        let [gripper, action, ..] = received.command.params;
        let order = match (whole(or_zero(gripper)), whole(action)) {
            (Some(0 | 1), Some(0)) => RemoteOrder::Release,
            (Some(0 | 1), Some(1)) => RemoteOrder::Grab,
            _ => return Some(self.deny("gripper 1: 0 releases, 1 grabs")),
        };
        self.give(received, order, procedure)
    }

    fn motor_test(&mut self, received: &Received<'_>) -> Option<MavResult> {
        let [motor, kind, throttle, seconds, count, ..] = received.command.params;
        let by_pulse = match whole(kind) {
            Some(kind) if kind == MotorTestThrottleType::MOTOR_TEST_THROTTLE_PERCENT as u32 => false,
            Some(kind) if kind == MotorTestThrottleType::MOTOR_TEST_THROTTLE_PWM as u32 => true,
            _ => return Some(self.deny("motor 1 to 4, one, in percent or us")),
        };
        let one = matches!(whole(or_zero(count)), Some(0 | 1));
        let (Some(rotor @ 1..=4), true) = (whole(motor), one) else {
            return Some(self.deny("motor 1 to 4, one, in percent or us"));
        };
        let spin = Spin::at(rotor as usize - 1, throttle / 100.0);
        let order = if throttle <= 0.0 || throttle.is_nan() {
            ActuatorTest::End
        } else if by_pulse {
            ActuatorTest::Spin(Spin {
                drive: received.vehicle.motor_pulses.command(throttle),
                probes: true,
                ..spin
            })
        } else {
            ActuatorTest::Spin(spin)
        };
        // 0, or not given, means the longest time.
        let shorter = seconds > 0.0 && seconds < SPIN_TIME;
        let seconds = if shorter { seconds } else { SPIN_TIME };
        self.try_actuator(received, Trial::new(order, received.now, seconds))
    }

    fn static_thrust(&mut self, received: &Received<'_>) -> Option<MavResult> {
        let [rotor, percent, other, seconds, run, ..] = received.command.params;
        if percent <= 0.0 {
            return self.try_actuator(received, Trial::new(ActuatorTest::End, received.now, 0.0));
        }
        let rotors = match whole(rotor) {
            Some(0) => Rotors::All,
            Some(rotor @ 1..=4) => Rotors::One(rotor as usize - 1),
            _ => return Some(self.deny("rotor 1 to 4, 0 for all")),
        };
        let Some(run @ 1..) = whole(run) else {
            return Some(self.deny("each run has a number, from 1"));
        };
        if run == self.orders.run {
            return self.renew(received, run);
        }
        let step_to = Some(or_zero(other)).filter(|other| *other != 0.0);
        let default = if step_to.is_some() { STEP_PLATEAU } else { PLATEAU };
        let test = StaticThrustTest {
            rotors,
            drive: percent / 100.0,
            step_to: step_to.map(|percent| percent / 100.0),
            plateau: if seconds > 0.0 { seconds } else { default },
        };
        if !test.is_allowed() {
            return Some(self.deny(ActuatorTestRefusal::OutOfRange.text()));
        }
        let order = ActuatorTest::StaticThrust(test);
        let mut trial = Trial::new(order, received.now, test.longest() + MARGIN);
        trial.renewed = Some((run, received.now));
        let begun = self.begin(received, Answerer::ActuatorTest);
        begun.err().unwrap_or_else(|| {
            self.orders.run = run;
            self.orders.trial = Some(trial);
            None
        })
    }

    /// Its sender is still there. A run that has ended stays so, however late its command is repeated.
    fn renew(&mut self, received: &Received<'_>, run: u32) -> Option<MavResult> {
        let trial = self
            .orders
            .trial
            .as_mut()
            .and_then(|trial| trial.renewed.as_mut());
        let Some((_, heard)) = trial.filter(|(renewed, _)| *renewed == run) else {
            return Some(self.refuse("this run has ended"));
        };
        *heard = received.now;
        // The command that began it may still wait for its answer.
        let waits = self
            .orders
            .pending
            .is_some_and(|p| p.by == Answerer::ActuatorTest);
        (!waits).then_some(MavResult::MAV_RESULT_ACCEPTED)
    }

    fn set_servo(&mut self, received: &Received<'_>) -> Option<MavResult> {
        let [output, pulse_us, ..] = received.command.params;
        let servo = whole(output).and_then(|output| output.checked_sub(FIRST_SERVO));
        let Some(servo @ 0..4) = servo else {
            return Some(self.deny("outputs 5 to 8 are the servos"));
        };
        let order = if pulse_us > 0.0 {
            ActuatorTest::Place(Place {
                servo: servo as usize,
                pulse_us,
            })
        } else {
            ActuatorTest::End
        };
        self.try_actuator(received, Trial::new(order, received.now, PLACE_TIME))
    }

    fn give(
        &mut self,
        received: &Received<'_>,
        order: RemoteOrder,
        procedure: &mut Procedure,
    ) -> Option<MavResult> {
        if order == RemoteOrder::Kill {
            // A kill does not wait for another command.
            self.acknowledge_pending(MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
            self.calibrations.cancel(procedure);
        }
        let begun = self.begin(received, Answerer::Remote);
        begun.err().unwrap_or_else(|| {
            self.orders.remote = Some(RemoteRequest { number: 0, order });
            None
        })
    }

    fn try_actuator(&mut self, received: &Received<'_>, trial: Trial) -> Option<MavResult> {
        let begun = self.begin(received, Answerer::ActuatorTest);
        begun.err().unwrap_or_else(|| {
            self.orders.trial = Some(trial);
            None
        })
    }

    /// Notes that the command is acknowledged later, `by` one part of the server.
    ///
    /// # Errors
    /// The acknowledgement to send now; `None` if it is a repetition of the one that waits.
    pub(super) fn begin(&mut self, received: &Received<'_>, by: Answerer) -> Result<(), Option<MavResult>> {
        let (command, to) = (received.command.number, received.from);
        match self.orders.pending {
            Some(p) if p.command == command && p.to == to => Err(None),
            Some(_) => Err(Some(self.refuse("another command is under way"))),
            None => {
                self.orders.pending = Some(Pending {
                    command,
                    by,
                    to,
                    since: received.now,
                });
                Ok(())
            }
        }
    }

    /// Acknowledges the waiting command, if its answer comes `by` this part.
    pub(super) fn settle(&mut self, by: Answerer, result: MavResult) {
        if self.orders.pending.is_some_and(|pending| pending.by == by) {
            self.acknowledge_pending(result);
        }
    }

    fn acknowledge_pending(&mut self, result: MavResult) {
        if let Some(Pending { command, to, .. }) = self.orders.pending.take() {
            self.acknowledge(command, to, result, 0);
        }
    }

    /// Reports the progress of the waiting command, %.
    pub(super) fn progress(&mut self, percent: u8) {
        if let Some(Pending { command, to, .. }) = self.orders.pending {
            self.acknowledge(command, to, MavResult::MAV_RESULT_IN_PROGRESS, percent);
        }
    }

    pub(super) fn settle_refused(&mut self, by: Answerer, why: &str) {
        let result = self.refuse(why);
        self.settle(by, result);
    }

    fn is_late(&self, by: Answerer, now: u64) -> bool {
        let pending = self.orders.pending.filter(|pending| pending.by == by);
        pending.is_some_and(|p| now.saturating_sub(p.since) > COMMANDER)
    }

    /// The requests to the commander at `now`, µs since the start, given its answers in `vehicle`.
    pub fn requests(&mut self, now: u64, vehicle: &Vehicle) -> CommanderRequests {
        CommanderRequests {
            remote: self.remote(now, vehicle),
            actuator_test: self.actuator_test(now, vehicle),
        }
    }

    fn remote(&mut self, now: u64, vehicle: &Vehicle) -> Option<RemoteRequest> {
        let late = self.is_late(Answerer::Remote, now);
        let request = self.orders.remote.as_mut()?;
        if request.number == 0 {
            match vehicle.answers.next() {
                Some(number) => request.number = number,
                None if !late => return None,
                None => {
                    self.orders.remote = None;
                    self.say_silent(Answerer::Remote);
                    return None;
                }
            }
        }
        let request = *request;
        let answer = vehicle.answers.remote;
        if answer.number != request.number && !late {
            return Some(request);
        }
        self.orders.remote = None;
        match answer.refusal {
            _ if answer.number != request.number => self.say_silent(Answerer::Remote),
            None => self.settle(Answerer::Remote, MavResult::MAV_RESULT_ACCEPTED),
            Some(RemoteRefusal::Checks) => {
                self.texts.name_checks();
                self.settle(Answerer::Remote, MavResult::MAV_RESULT_TEMPORARILY_REJECTED);
            }
            Some(why) => self.settle_refused(Answerer::Remote, why.text()),
        }
        None
    }

    fn actuator_test(&mut self, now: u64, vehicle: &Vehicle) -> Option<ActuatorTestRequest> {
        let (view, late) = (
            vehicle.answers.actuator_test,
            self.is_late(Answerer::ActuatorTest, now),
        );
        let trial = self.orders.trial.as_mut()?;
        if trial.request.number == 0 {
            match view.next(self.orders.own) {
                Ok(number) => {
                    trial.request.number = number;
                    self.orders.own = number;
                }
                Err(why) => {
                    self.orders.trial = None;
                    self.settle_refused(Answerer::ActuatorTest, why.text());
                    return None;
                }
            }
        }
        let request = trial.request;
        let state = (view.answer.number == request.number).then_some(view.answer.state);
        match state {
            None if !late => return Some(request),
            Some(ActuatorTestState::Running) => {
                let abandoned = trial.is_abandoned(now);
                if trial.is_over(now) {
                    trial.renewed = None;
                    trial.request = ActuatorTestRequest {
                        number: 0,
                        order: ActuatorTest::End,
                    };
                }
                self.settle(Answerer::ActuatorTest, MavResult::MAV_RESULT_ACCEPTED);
                if abandoned {
                    self.refuse("run not renewed: it ends");
                }
                return Some(request);
            }
            None => self.say_silent(Answerer::ActuatorTest),
            Some(ActuatorTestState::Done) => {
                self.settle(Answerer::ActuatorTest, MavResult::MAV_RESULT_ACCEPTED)
            }
            Some(ActuatorTestState::Refused(ActuatorTestRefusal::OutOfRange)) => {
                let result = self.deny(ActuatorTestRefusal::OutOfRange.text());
                self.settle(Answerer::ActuatorTest, result);
            }
            Some(ActuatorTestState::Refused(why) | ActuatorTestState::Ended(why)) => {
                self.settle_refused(Answerer::ActuatorTest, why.text())
            }
        }
        self.orders.trial = None;
        None
    }

    fn say_silent(&mut self, by: Answerer) {
        self.refuse("the commander is silent");
        self.settle(by, MavResult::MAV_RESULT_FAILED);
    }
}
