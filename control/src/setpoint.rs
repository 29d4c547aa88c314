//! What the mode logic wants of rotors and tendons.

use crate::rc::ArmChoice;
use crate::vector::Vec3;
use crate::wrench::Wrench;

/// What the rotors are to do.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Setpoint {
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
    /// Off the pipe: as [`Setpoint::Angle`], with nothing kept of what the loops held on it.
    Escape {
        /// Roll, rad.
        roll: f32,
        /// Pitch, rad.
        pitch: f32,
        /// Yaw rate, rad/s.
        yaw_rate: f32,
        /// Collective thrust, N.
        thrust: f32,
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

impl Setpoint {
    /// True when the rotors turn.
    pub fn spin(self) -> bool {
        self != Self::Stop
    }

    /// Collective thrust, N; 0 when stopped or idle.
    pub fn thrust(self) -> f32 {
        match self {
            Self::Stop | Self::Idle => 0.0,
            Self::Angle { thrust, .. }
            | Self::Escape { thrust, .. }
            | Self::Rate { thrust, .. }
            | Self::Resting { thrust, .. } => thrust,
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
            }
            | Self::Escape {
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
pub enum ClampCommand {
    /// Slack, servos at their release position.
    #[default]
    Release,
    /// Close these arms to the grip pressure and hold it.
    Close {
        /// Which arms.
        arms: ArmChoice,
    },
    /// Nothing yet: no pulse to the servos, whose gears hold what they held when the power came on.
    Keep,
}
