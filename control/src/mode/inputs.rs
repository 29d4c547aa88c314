//! Inputs of the mode logic and their direct consequences: autonomous perching, orders of ground station and actuator tests,
//! dangers.

pub mod actuator_tests;
pub mod auto_perch;
pub mod dangers;
pub mod remote;

use crate::allocation::wrench::PerArm;
use crate::approach::pipe_target::PipeTarget;
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::attitude::motion::Motion;
use crate::battery::ServoSupply;
use crate::gripper::grip::GripState;
use crate::navigation::estimate::Estimate;
use crate::navigation::fix_age::{APPROACH_AGE, FRESH_AGE, HEIGHT_AGE, PRESSURE_AGE, WAITING_AGE};
use crate::pilot::actuator_test::ActuatorTestRequest;
use crate::pilot::rc::Sticks;
use crate::pilot::remote::RemoteRequest;

/// Inputs of one step; `None` stands for a stale message.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    /// The pilot's sticks; `None` when the radio is lost.
    pub sticks: Option<Sticks>,
    /// Motion of the body.
    pub motion: Option<Motion>,
    /// Demanded thrust along body -z, Σ T cos α, N; 0 when stopped.
    pub lift: f32,
    /// Demanded roll moment, right side down positive, N m; 0 when stopped.
    pub roll_moment: f32,
    /// The grip.
    pub grip: Option<GripState>,
    /// Tilts of the arms by their sensors, rad; `None` where not fresh.
    pub tilts: PerArm<Option<f32>>,
    /// Pressure sensors that are faulty or silent.
    pub fsr_fault: PerArm<bool>,
    /// Battery voltage under load, V.
    pub battery: Option<f32>,
    /// The servo battery.
    pub servo_supply: ServoSupply,
    /// The flight level misses its deadlines.
    pub late: bool,
    /// Arming inhibits of drivers, storage and start-up.
    pub hardware: ArmingInhibits,
    /// Request at the console.
    pub actuator_test: Option<ActuatorTestRequest>,
    /// Order of a remote link.
    pub remote: Option<RemoteRequest>,
    /// Position estimate; its age is the time since it became inertial only.
    pub position: Option<Estimate>,
    /// Position of the pipe, in the axes of the poses.
    pub target: Option<PipeTarget>,
}

impl Inputs {
    /// Reason for which the servo battery forbids a perch, or the continuation of one.
    pub fn servo_trouble(&self) -> Option<ArmingInhibit> {
        match self.servo_supply {
            ServoSupply::Silent => Some(ArmingInhibit::ServoBatterySilent),
            ServoSupply::Low => Some(ArmingInhibit::ServoBatteryLow),
            ServoSupply::NotFitted | ServoSupply::NearEnd | ServoSupply::Good => None,
        }
    }

    /// The position is known well enough to begin a hold.
    pub fn position_fresh(&self) -> bool {
        self.motion.is_some() && self.position_younger(FRESH_AGE)
    }

    /// Dead reckoning has lasted too long for an approach.
    pub fn position_adrift(&self) -> bool {
        !self.position_younger(APPROACH_AGE)
    }

    /// An approach has waited too long for the position.
    pub fn position_awaited(&self) -> bool {
        !self.position_younger(WAITING_AGE)
    }

    /// The position, including the height, has been lost.
    pub fn position_lost(&self) -> bool {
        let by_pressure = self.position.is_some_and(|e| e.by_pressure);
        !self.position_younger(if by_pressure { PRESSURE_AGE } else { HEIGHT_AGE })
    }

    fn position_younger(&self, age: f32) -> bool {
        self.position.is_some_and(|e| e.age <= age)
    }

    /// Drops messages with a non-finite value: NaN must not stay in a filter or in the attitude held on the pipe. An
    /// arm switch that is off still stops the rotors.
    pub(super) fn finite(self) -> Self {
        let sane = |m: &Motion| m.q.is_finite() && m.rate.is_finite() && m.accel.is_finite();
        let steady = |s: &Sticks| (s.roll + s.pitch + s.yaw + s.throttle).is_finite();
        Self {
            sticks: self.sticks.and_then(|s| match (steady(&s), s.arm_switch) {
                (true, _) => Some(s),
                (false, true) => None,
                (false, false) => Some(Sticks {
                    roll: 0.0,
                    pitch: 0.0,
                    yaw: 0.0,
                    throttle: 0.0,
                    ..s
                }),
            }),
            motion: self.motion.filter(sane),
            tilts: self.tilts.map(|tilt| tilt.filter(|t| t.is_finite())),
            battery: self.battery.filter(|v| v.is_finite()),
            position: self.position.filter(Estimate::is_finite),
            target: self.target.filter(PipeTarget::is_finite),
            ..self
        }
    }
}
