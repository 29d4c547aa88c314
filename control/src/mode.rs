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
//!
//! From Flight with the perch switch on, Contact, Clamping and Releasing a slide, a closing that is given up or a fall leads
//! to Escaping, and from there to Flight when the throttle carries, to Failsafe when the throttle is not moved.
//!
//! A vehicle that is disarmed with its arms closed (by a person, by a danger, or because the board restarted on the
//! pipe) becomes Perched by the arming gesture.

mod closing;
mod decide;
mod demand;
mod escape;
mod failsafe;
mod hold;
mod lean;
mod logic;
mod look;
mod reason;
#[cfg(test)]
mod tests;

pub use self::logic::ModeLogic;
pub use self::reason::Reason;
use crate::arming::Refusals;
use crate::grip::GripState;
use crate::grip_memory::GripMemory;
use crate::rc::Sticks;
use crate::setpoint::{ClampCommand, Setpoint};
use crate::vector::{Quat, Vec3};
use crate::wrench::PerArm;

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
    /// Leaving the pipe by itself after a slide or a closing that was given up, until the pilot takes the throttle.
    Escaping,
}

impl Mode {
    /// Every mode, in the order of a mission.
    pub const ALL: [Self; 11] = [
        Self::Calibrating,
        Self::Disarmed,
        Self::Armed,
        Self::Flight,
        Self::Contact,
        Self::Clamping,
        Self::Perched,
        Self::Releasing,
        Self::Escaping,
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
            Self::Escaping => "ESCAPING",
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
    pub grip: Option<GripState>,
    /// Pressure sensors that are faulty or silent.
    pub fsr_fault: PerArm<bool>,
    /// Battery voltage under load, V.
    pub battery: Option<f32>,
    /// The flight level misses its deadlines.
    pub late: bool,
    /// What the drivers, the storage and the start report against arming.
    pub hardware: Refusals,
}

impl Inputs {
    /// Drops every message with a non-finite value, as if it were stale: NaN must not stay in a filter or in the attitude
    /// held on the pipe. An arm switch that is off still stops the rotors.
    fn finite(self) -> Self {
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
            battery: self.battery.filter(|v| v.is_finite()),
            ..self
        }
    }
}

/// What the mode logic decides in one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// State of the vehicle.
    pub mode: Mode,
    /// What the rotors are to do.
    pub rotors: Setpoint,
    /// What the tendons are to do.
    pub tendons: ClampCommand,
    /// The grip that must outlive a reset.
    pub grip_memory: GripMemory,
    /// Why arming is refused, the failsafe acts or the last state was left; `None` when nothing is wrong.
    pub reason: Option<Reason>,
    /// Everything against arming; empty while armed.
    pub refusals: Refusals,
}
