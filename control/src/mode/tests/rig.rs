//! The mode logic in a simple world that carries it or does not.

use crate::attitude::motion::Motion;
use crate::chain::setpoint::Setpoint;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::grip::{ArmGrip, ArmState, GripState};
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::GRAVITY;
use crate::maths::vector::Vec3;
use crate::mode::shared::on_pipe::SPOOL_DOWN_TIME;
use crate::mode::states::clamping::STOP_TIME;
use crate::mode::states::contact::CONTACT_TIME;
use crate::mode::*;
use crate::params::Params;
use crate::pilot::rc::{ArmChoice, Sticks};
use crate::position_hold::gains::HoldGains;

pub(super) const DT: f32 = 0.01;

#[derive(Clone)]
pub(super) struct Rig {
    pub(super) logic: ModeLogic,
    pub(super) inputs: Inputs,
    pub(super) carried: bool,
    /// Sink rate at touch-down, m/s.
    pub(super) falling: f32,
    pub(super) out: Outputs,
    pub(super) params: Params,
}

impl Rig {
    pub(super) fn new() -> Self {
        Self::with(Params::default())
    }

    pub(super) fn with(params: Params) -> Self {
        let inputs = Inputs {
            sticks: Some(Sticks::default()),
            motion: Some(Motion::default()),
            grip: Some(GripState {
                released: true,
                ..Default::default()
            }),
            battery: Some(16.0),
            ..Default::default()
        };
        Self {
            logic: ModeLogic::new(&params),
            inputs,
            carried: true,
            falling: 0.0,
            out: Outputs::default(),
            params,
        }
    }

    /// Restarts the board with this grip retained.
    pub(super) fn restart(&mut self, grip_memory: GripMemory) {
        self.logic = ModeLogic::resume(&self.params, &HoldGains::of(&self.params), grip_memory, None);
    }

    pub(super) fn sticks(&mut self) -> &mut Sticks {
        self.inputs.sticks.get_or_insert_default()
    }

    pub(super) fn grip(&mut self, proven: bool, released: bool, state: ArmState, pressure: f32) {
        let arm = ArmGrip {
            state,
            pressure,
            ..Default::default()
        };
        self.inputs.grip = Some(GripState {
            proven,
            misfit: None,
            released,
            arms: [arm; 4],
        });
    }

    pub(super) fn step(&mut self) {
        self.inputs.lift = self.out.rotors.thrust();
        if let Some(m) = &mut self.inputs.motion {
            let felt = if self.carried {
                // The first step removes the speed.
                GRAVITY + core::mem::take(&mut self.falling) / DT
            } else {
                // The mixer divides by the factor; the rotors are those of the parameters.
                let thrust = self.inputs.lift / self.out.thrust_factor.value;
                let felt = thrust / self.params.mass;
                self.falling += (GRAVITY - felt) * DT;
                felt
            };
            m.accel = Vec3::new(0.0, 0.0, -felt);
        }
        self.out = self.logic.step(&self.inputs, DT);
    }

    pub(super) fn run(&mut self, seconds: f32) -> Mode {
        for _ in 0..(seconds / DT + 0.5) as u32 {
            self.step();
        }
        self.out.mode
    }

    pub(super) fn expect(&mut self, seconds: f32, mode: Mode) {
        let got = self.run(seconds);
        assert_eq!(got, mode, "after {seconds} s, reason {:?}", self.out.reason);
    }

    pub(super) fn armed() -> Self {
        let mut r = Self::new();
        r.arm_at_rest();
        r
    }

    fn arm_at_rest(&mut self) {
        let r = self;
        r.expect(0.5, Mode::Calibrating);
        r.inputs.motion = Some(Motion {
            calibrated: true,
            ..Default::default()
        });
        r.expect(0.1, Mode::Disarmed);
        *r.sticks() = Sticks {
            arm_switch: true,
            yaw: 1.0,
            ..Default::default()
        };
        r.expect(0.9, Mode::Disarmed);
        r.expect(0.2, Mode::Armed);
        assert_eq!(r.out.rotors, Setpoint::Idle);
        r.sticks().yaw = 0.0;
    }

    pub(super) fn flying() -> Self {
        let mut r = Self::new();
        r.fly();
        r
    }

    /// Arms and takes off.
    pub(super) fn fly(&mut self) {
        self.arm_at_rest();
        let r = self;
        r.sticks().throttle = 0.53;
        r.carried = false;
        r.expect(1.0, Mode::Flight);
    }

    /// In flight for long enough to know its thrust.
    pub(super) fn flown() -> Self {
        let mut r = Self::flying();
        let hover = r.params.mass * GRAVITY / (4.0 * r.params.thrust_max);
        for (throttle, seconds) in [(hover + 0.06, 0.5), (hover, 5.0), (hover - 0.06, 0.5)] {
            for _ in 0..(seconds / DT) as u32 {
                r.sticks().throttle = throttle / r.out.thrust_factor.value;
                r.step();
            }
        }
        r.sticks().throttle = 0.53;
        r
    }

    pub(super) fn touched() -> Self {
        Self::touched_with(Params::default())
    }

    fn touched_with(params: Params) -> Self {
        let mut r = Self::with(params);
        r.fly();
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = true;
        r.expect(1.0, Mode::Flight);
        r.carried = true;
        r.expect(0.02, Mode::Flight);
        r.expect(0.15, Mode::Contact);
        r
    }

    pub(super) fn clamping() -> Self {
        Self::clamping_with(Params::default())
    }

    pub(super) fn clamping_with(params: Params) -> Self {
        let mut r = Self::touched_with(params);
        r.grip(false, false, ArmState::Closing, 0.0);
        r.expect(CONTACT_TIME + 0.1, Mode::Clamping);
        assert_eq!(r.out.tendons, ClampCommand::Close { arms: ArmChoice::All });
        r
    }

    pub(super) fn perched() -> Self {
        let mut r = Self::clamping();
        r.expect(3.0, Mode::Clamping);
        r.grip(true, false, ArmState::Holding, 950.0);
        r.expect(SPOOL_DOWN_TIME + STOP_TIME + 0.1, Mode::Perched);
        r.sticks().throttle = 0.0;
        r.expect(5.0, Mode::Perched);
        assert_eq!(r.out.reason, None);
        r
    }

    pub(super) fn releasing() -> Self {
        let mut r = Self::perched();
        r.sticks().throttle = 0.3;
        r.sticks().perch_switch = false;
        r.expect(0.1, Mode::Releasing);
        r
    }
}
