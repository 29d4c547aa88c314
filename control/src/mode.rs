//! The vehicle's modes, and the inputs and outputs of the mode logic, stepped at 100 Hz.
//!
//! Each mode has a file with its state (`behaviour::Behaviour`); `context` holds what outlives it. `transitions` is the
//! table of transitions by priority, shown in `docs/modes.md`, with conditions in `guards` and entry functions in
//! `entries`.

mod behaviour;
mod context;
mod inputs;
mod logic;
mod reason;
mod shared;
mod states;
mod table;
#[cfg(test)]
mod tests;

use self::behaviour::Behaviour;
use self::context::Step;
pub use self::logic::ModeLogic;
pub use self::reason::Reason;
pub use self::states::escaping::{AWAY_LEAN as ESCAPE_LEAN, LIFT_SHARE as ESCAPE_LIFT};
use crate::allocation::wrench::PerArm;
use crate::approach::pipe_target::PipeTarget;
use crate::arming::{ArmingInhibit, ArmingInhibits};
use crate::battery::ServoSupply;
use crate::chain::setpoint::{ClampCommand, Setpoint};
use crate::gripper::grip::GripState;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar::{self, GRAVITY, deg};
use crate::maths::vector::{Quat, Vec3};
use crate::navigation::position_estimator;
use crate::pilot::bench_orders::{BenchAnswer, BenchRequest};
use crate::pilot::rc::Sticks;
use crate::pilot::remote::{RemoteAnswer, RemoteRequest};

/// Declares the modes in mission order: name, file, number in records, name on displays.
macro_rules! modes {
    ($($(#[$doc:meta])+ $name:ident in $file:ident = $number:literal, $text:literal;)+) => {
        /// Mode of the vehicle; only the commander changes it.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum Mode { $($(#[$doc])+ $name = $number,)+ }

        impl Mode {
            /// Every mode, in mission order.
            pub const ALL: [Self; [$($number),+].len()] = [$(Self::$name),+];

            /// Name for displays and telemetry, at most 12 ASCII characters.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => $text,)+ }
            }
        }

        /// A mode with its fields.
        #[derive(Clone, Copy, Debug, PartialEq)]
        enum State { $($name(states::$file::$name),)+ }

        impl State {
            fn mode(&self) -> Mode {
                match self { $(Self::$name(_) => Mode::$name,)+ }
            }

            fn behaviour(&self) -> &dyn Behaviour {
                match self { $(Self::$name(state) => state,)+ }
            }

            fn behaviour_mut(&mut self) -> &mut dyn Behaviour {
                match self { $(Self::$name(state) => state,)+ }
            }
        }

        /// Entry function: previous state, this step, reason.
        #[derive(Clone, Copy, Debug)]
        #[expect(dead_code, reason = "no transition leads to the mode of the start")]
        enum Entry { $($name(fn(&State, &mut Step<'_>, Option<Reason>) -> states::$file::$name),)+ }

        impl Entry {
            fn enter(self, from: &State, step: &mut Step<'_>, why: Option<Reason>) -> State {
                match self { $(Self::$name(enter) => State::$name(enter(from, step, why)),)+ }
            }

            #[cfg(test)]
            fn mode(self) -> Mode {
                match self { $(Self::$name(_) => Mode::$name,)+ }
            }
        }
    };
}

modes! {
    /// Sensors are being calibrated at rest; arming is refused.
    #[default]
    Calibrating in calibrating = 0, "CALIBRATING";
    /// Motors stopped, ready to be armed.
    Disarmed in disarmed = 1, "DISARMED";
    /// Rotors idle on the ground, throttle low.
    Armed in armed = 2, "ARMED";
    /// Free flight under the pilot's sticks.
    Flight in flight = 3, "FLIGHT";
    /// Free flight that holds the position; the sticks ask for velocities.
    Hold in hold = 11, "HOLD";
    /// Free flight onto the pipe, or off it, by itself.
    Approach in approach = 12, "APPROACH";
    /// Resting on the pipe with the rotors still helping; attitude held, yaw given up.
    Contact in contact = 4, "CONTACT";
    /// Tendons closing the chosen arms under the pressure loop; rotors spool down once the grip is proven.
    Clamping in clamping = 5, "CLAMPING";
    /// Grip proven, rotors stopped.
    Perched in perched = 6, "PERCHED";
    /// Rotors spooled up again, tendons paying out until every arm is proven free.
    Releasing in releasing = 7, "RELEASING";
    /// Leaving the pipe by itself after a slide or a closing that was given up, until the pilot takes the throttle.
    Escaping in escaping = 10, "ESCAPING";
    /// On the ground again, rotors idle, about to disarm.
    Landed in landed = 8, "LANDED";
    /// The pilot is lost or the battery empty: descend, stop on whatever carries.
    Failsafe in failsafe = 9, "FAILSAFE";
}

impl Mode {
    /// The mode called `name`.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// The rotors stand still. In other modes the transitions that stop everything apply.
    pub const fn rotors_stand(self) -> bool {
        matches!(self, Self::Calibrating | Self::Disarmed | Self::Perched)
    }
}

/// Estimated motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Body to world.
    pub q: Quat,
    /// Angular rate, rad/s, body.
    pub rate: Vec3,
    /// Specific force, m/s², body.
    pub accel: Vec3,
    /// True once calibration at rest has ended.
    pub calibrated: bool,
}

/// Largest angle between gravity and the attitude at rest, rad: an accelerometer's bias of 60 mg is 3.4°, and arms sway.
const UNSEEN_LEAN: f32 = deg(10.0);
/// Specific force at which the accelerometer says where down is, share of gravity.
const RESTING_FORCE: core::ops::RangeInclusive<f32> = 0.8..=1.2;

impl Motion {
    /// At rest the accelerometer says that the vehicle leans otherwise than it is taken to: the gyro's bias has stepped, or it
    /// has turned faster than the gyro reads.
    pub(crate) fn leans_unseen(&self) -> bool {
        let force = self.accel.norm();
        let along = -self.accel.dot(self.q.down_in_body());
        RESTING_FORCE.contains(&(force / GRAVITY)) && along < force * scalar::cos(UNSEEN_LEAN)
    }
}

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
    pub bench: Option<BenchRequest>,
    /// Order of a remote link.
    pub remote: Option<RemoteRequest>,
    /// Where the vehicle is; its own age says since when that is only by the inertial sensor.
    pub position: Option<position_estimator::Estimate>,
    /// Where the pipe is, in the axes of the poses.
    pub target: Option<PipeTarget>,
}

impl Inputs {
    /// Why the servo battery allows no perch, nor a longer one.
    pub fn servo_trouble(&self) -> Option<ArmingInhibit> {
        match self.servo_supply {
            ServoSupply::Silent => Some(ArmingInhibit::ServoBatterySilent),
            ServoSupply::Low => Some(ArmingInhibit::ServoBatteryLow),
            ServoSupply::NotFitted | ServoSupply::NearEnd | ServoSupply::Good => None,
        }
    }

    /// Drops messages with a non-finite value: NaN must not stay in a filter or in the attitude held on the pipe. An
    /// arm switch that is off still stops the rotors.
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
            tilts: self.tilts.map(|tilt| tilt.filter(|t| t.is_finite())),
            battery: self.battery.filter(|v| v.is_finite()),
            position: self.position.filter(position_estimator::Estimate::is_finite),
            target: self.target.filter(PipeTarget::is_finite),
            ..self
        }
    }
}

/// Outputs of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Mode.
    pub mode: Mode,
    /// Rotors.
    pub rotors: Setpoint,
    /// Tendons.
    pub tendons: ClampCommand,
    /// Grip to retain across a reset.
    pub grip_memory: GripMemory,
    /// Why arming is refused, the failsafe acts or the last state was left; `None` if nothing is wrong.
    pub reason: Option<Reason>,
    /// Everything against arming; empty while armed.
    pub inhibits: ArmingInhibits,
    /// Answer to the newest bench order.
    pub bench: BenchAnswer,
    /// Answer to the newest order of a remote link.
    pub remote: RemoteAnswer,
}
