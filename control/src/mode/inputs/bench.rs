//! Bench orders: a builder gives them at the console; they begin and last in DISARMED alone.

use crate::allocation::motor_pulses::MotorPulses;
use crate::arming::ArmingInhibit;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::inputs::Inputs;
use crate::mode::modes::Mode;
use crate::params::Params;
use crate::pilot::bench_orders::{BenchAnswer, BenchOrder, BenchRefusal, BenchRequest, BenchState};

/// Conditions under which a bench order may begin and continue.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    mode: Mode,
    grip_memory: GripMemory,
    arm_switch: bool,
    storing: bool,
    /// The attitude is fresh: the motors' path runs.
    motion: bool,
    /// The motor pulses are in rising order.
    pulses: bool,
}

impl Table {
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
    fn refusal(&self, order: &BenchOrder, propellers_off: bool) -> Option<BenchRefusal> {
        let spins = matches!(order, BenchOrder::Spin(_));
        let moves = spins || matches!(order, BenchOrder::Place(_));
        let reasons = [
            (BenchRefusal::NotDisarmed, self.mode != Mode::Disarmed),
            (BenchRefusal::ArmSwitchOn, self.arm_switch),
            (BenchRefusal::Storing, self.storing),
            (
                BenchRefusal::GripUnknown,
                moves && self.grip_memory == GripMemory::Unknown,
            ),
            (
                BenchRefusal::ArmsClosed,
                moves && self.grip_memory.arms().is_some(),
            ),
            (BenchRefusal::PropellersOn, spins && !propellers_off),
            (BenchRefusal::ImuSilent, spins && !self.motion),
            (BenchRefusal::MotorPulses, spins && !self.pulses),
            (BenchRefusal::OutOfRange, !order.is_allowed()),
        ];
        let ends = *order == BenchOrder::End;
        reasons
            .into_iter()
            .find(|&(_, holds)| holds && !ends)
            .map(|(why, _)| why)
    }
}

/// An order that lasts, with its remaining time, s.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Running {
    order: BenchOrder,
    time: f32,
}

/// The orders of the bench since power-up.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bench {
    /// Confirmed since power-up and since the vehicle was last armed.
    propellers_off: bool,
    answer: BenchAnswer,
    running: Option<Running>,
}

impl Bench {
    /// One step of `dt` s; `request` is `None` when the console has not renewed it.
    pub fn step(&mut self, request: Option<BenchRequest>, table: &Table, dt: f32) {
        self.propellers_off &= matches!(table.mode, Mode::Calibrating | Mode::Disarmed);
        match (request, self.running) {
            (Some(request), _) if request.number != self.answer.number => self.begin(request, table),
            (Some(_), Some(running)) => self.keep(running, table, dt),
            (None, Some(_)) => self.finish(BenchState::Ended(BenchRefusal::NotRenewed)),
            (_, None) => (),
        }
    }

    fn begin(&mut self, BenchRequest { number, order }: BenchRequest, table: &Table) {
        self.answer.number = number;
        self.running = None;
        self.answer.state = match (table.refusal(&order, self.propellers_off), order) {
            (Some(why), _) => BenchState::Refused(why),
            (None, BenchOrder::End) => BenchState::Done,
            (None, BenchOrder::PropellersOff) => {
                self.propellers_off = true;
                BenchState::Done
            }
            (None, BenchOrder::Spin(_) | BenchOrder::Place(_)) => {
                self.running = Some(Running { order, time: 0.0 });
                BenchState::Running
            }
        };
    }

    fn keep(&mut self, running: Running, table: &Table, dt: f32) {
        let time = running.time + dt;
        if let Some(why) = table.refusal(&running.order, self.propellers_off) {
            self.finish(BenchState::Ended(why));
        } else if time < running.order.longest() {
            self.running = Some(Running { time, ..running });
        } else {
            self.finish(BenchState::Done);
        }
    }

    /// Ends the running order: someone disarms.
    pub fn stop(&mut self) {
        if self.running.is_some() {
            self.finish(BenchState::Ended(BenchRefusal::Disarm));
        }
    }

    fn finish(&mut self, state: BenchState) {
        self.running = None;
        self.answer.state = state;
    }

    /// The running order.
    pub fn order(&self) -> Option<BenchOrder> {
        self.running.map(|running| running.order)
    }

    /// Reply to the newest order.
    pub fn answer(&self) -> BenchAnswer {
        self.answer
    }
}
