//! The states of the vehicle, and what the mode logic sees and decides.
//!
//! ```text
//! Calibrating ─> Disarmed <─> Armed ─> Flight <─> Landed ─> Disarmed
//!                                       │  ^  \
//!                     touch, perch on   v  │   ─> Failsafe ─> Disarmed
//!                                   Contact│
//!                                       v  │ all arms proven free
//!                                   Clamping ─> Releasing
//!                        grip proven,   v        ^
//!                        rotors stopped Perched ─┘ perch off, throttle up
//! ```

mod closing;
mod decide;
mod demand;
mod failsafe;
mod hold;
mod logic;
#[cfg(test)]
mod random;
#[cfg(test)]
mod rig;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod trouble;

pub use self::logic::ModeLogic;
use crate::arming::Refusals;
use crate::grip::ArmGrip;
use crate::rc::{ArmChoice, Sticks};
use crate::vector::{Quat, Vec3};
use crate::wrench::{PerArm, Wrench};

/// What the vehicle is doing; the commander alone changes it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mode {
    /// Sensors are being calibrated at rest; arming is refused.
    #[default]
    Calibrating,
    /// Motors stopped, ready to be armed.
    Disarmed,
    /// Rotors idle on the ground, throttle low.
    Armed,
    /// Free flight under the pilot's sticks.
    Flight,
    /// Resting on the pipe with the rotors still helping; attitude held, yaw given up.
    Contact,
    /// Tendons closing the chosen arms under the pressure loop; rotors spool down once the grip is proven.
    Clamping,
    /// Grip proven, rotors stopped.
    Perched,
    /// Rotors spooled up again, tendons paying out until every arm is proven free.
    Releasing,
    /// On the ground again, rotors idle, about to disarm.
    Landed,
    /// The pilot is lost or the battery empty: descend, stop on whatever carries.
    Failsafe,
}

impl Mode {
    /// Every mode, in the order of a mission.
    pub const ALL: [Self; 10] = [
        Self::Calibrating,
        Self::Disarmed,
        Self::Armed,
        Self::Flight,
        Self::Contact,
        Self::Clamping,
        Self::Perched,
        Self::Releasing,
        Self::Landed,
        Self::Failsafe,
    ];

    /// Name for displays and telemetry, at most 12 ASCII characters.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Calibrating => "CALIBRATING",
            Self::Disarmed => "DISARMED",
            Self::Armed => "ARMED",
            Self::Flight => "FLIGHT",
            Self::Contact => "CONTACT",
            Self::Clamping => "CLAMPING",
            Self::Perched => "PERCHED",
            Self::Releasing => "RELEASING",
            Self::Landed => "LANDED",
            Self::Failsafe => "FAILSAFE",
        }
    }

    /// The mode called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }
}

/// Estimated motion, as far as the mode logic needs it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Body to world.
    pub q: Quat,
    /// Angular rate, rad/s, body.
    pub rate: Vec3,
    /// Specific force, m/s², body.
    pub accel: Vec3,
    /// Calibration at rest has ended.
    pub calibrated: bool,
}

/// What the clamp loop says of the grip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Grip {
    /// Every chosen arm held the pressure for the dwell time with a force below the limit.
    pub proven: bool,
    /// Every arm is free.
    pub released: bool,
    /// Arm by arm.
    pub arms: PerArm<ArmGrip>,
}

/// What the mode logic sees in one step; `None` stands for a message that is stale.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Inputs {
    /// The pilot's wishes; `None` when the radio is lost.
    pub sticks: Option<Sticks>,
    /// Motion of the body.
    pub motion: Option<Motion>,
    /// Thrust asked of the rotors along body -z, Σ T cos α, N; 0 when stopped.
    pub lift: f32,
    /// The grip.
    pub grip: Option<Grip>,
    /// Pressure sensors that are faulty or silent.
    pub fsr_fault: PerArm<bool>,
    /// Battery voltage under load, V.
    pub battery: Option<f32>,
    /// The flight level misses its deadlines.
    pub late: bool,
}

/// What the rotors are to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rotors {
    /// Stopped.
    #[default]
    Stop,
    /// Idle, controllers reset.
    Idle,
    /// Hold roll and pitch (rad), turn at a yaw rate (rad/s), with a collective thrust (N).
    Angle {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
        /// Yaw rate, rad/s.
        yaw_rate: f32,
        /// Collective thrust, N.
        thrust: f32,
    },
    /// Turn at body rates (rad/s) with a collective thrust (N).
    Rate {
        /// Body rates, rad/s.
        rate: Vec3,
        /// Collective thrust, N.
        thrust: f32,
    },
    /// This wrench.
    Direct {
        /// The wrench.
        wrench: Wrench,
    },
    /// On the pipe: hold roll and pitch (rad) without integral action, give yaw up.
    Resting {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
        /// Collective thrust, N.
        thrust: f32,
    },
}

impl Rotors {
    /// True when the rotors turn.
    pub fn spin(self) -> bool {
        self != Self::Stop
    }

    /// Collective thrust, N; 0 when stopped or idle.
    pub fn thrust(self) -> f32 {
        match self {
            Self::Stop | Self::Idle => 0.0,
            Self::Angle { thrust, .. } | Self::Rate { thrust, .. } | Self::Resting { thrust, .. } => thrust,
            Self::Direct { wrench } => wrench.thrust,
        }
    }

    /// True when every number in it is finite.
    pub fn is_finite(self) -> bool {
        let sum = match self {
            Self::Stop | Self::Idle => 0.0,
            Self::Angle {
                roll,
                pitch,
                yaw_rate,
                ..
            } => roll + pitch + yaw_rate,
            Self::Rate { rate, .. } => rate.x + rate.y + rate.z,
            Self::Direct { wrench } => wrench.roll + wrench.pitch + wrench.yaw,
            Self::Resting { roll, pitch, .. } => roll + pitch,
        };
        sum.is_finite() && self.thrust().is_finite()
    }
}

/// What the tendons are to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tendons {
    /// Pay out.
    #[default]
    Release,
    /// Close these arms and hold.
    Close(ArmChoice),
}

/// What the mode logic decides in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// State of the vehicle.
    pub mode: Mode,
    /// What the rotors are to do.
    pub rotors: Rotors,
    /// What the tendons are to do.
    pub tendons: Tendons,
    /// Why arming is refused, the failsafe acts or the last state was left; empty when nothing is wrong.
    pub reason: &'static str,
    /// Everything against arming; empty while armed.
    pub refusals: Refusals,
}
