//! Holding on the pipe: attitude, share of the collective, grip.

use crate::allocation::wrench::Wrench;
use crate::chain::setpoint::Setpoint;
use crate::gripper::grip::{ArmGrip, ArmState, GripState, HELD_SHARE};
use crate::gripper::grip_geometry::Misfit;
use crate::maths::scalar::clamp_abs;
use crate::mode::inputs::Inputs;
use crate::mode::reason::Reason;
use crate::params::Params;
use crate::pilot::rc::ArmChoice;

/// Ramp time from 0 to the pilot's collective, s.
pub const SPOOL_TIME: f32 = 1.5;
/// Ramp time to stopped rotors, s: the arms take over the roll moment by which the rotors hold a vehicle beside the
/// crown.
pub const SPOOL_DOWN_TIME: f32 = 3.0;
/// Rate of levelling a lean at contact, rad/s.
const LEVEL_RATE: f32 = 0.2;
/// Time constant of the held attitude following the present one, s.
const FOLLOW_TIME: f32 = 1.0;
/// Share of the collective below which the grip alone holds the attitude.
const LIFT_SHARE: f32 = 0.5;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PipeAttitudeHold {
    /// Held roll, rad.
    pub roll: f32,
    /// Held pitch, rad.
    pub pitch: f32,
    /// Arms chosen at contact; the switch is ignored until they are free.
    pub arms: ArmChoice,
}

impl PipeAttitudeHold {
    /// Levels the roll by one step: on the crown of a pipe, an unstable seat, a held lean would grow as the rotors
    /// return the weight. Pitch stays: it is the pipe's slope.
    pub fn levelled(self, dt: f32) -> Self {
        Self {
            roll: self.roll - clamp_abs(self.roll, LEVEL_RATE * dt),
            ..self
        }
    }

    /// Follows the present attitude by one step: the grip holds it, and the rotors must not stop with a jolt.
    pub fn following(self, i: &Inputs, dt: f32) -> Self {
        let Some(motion) = i.motion else {
            return self;
        };
        let (roll, pitch, _) = motion.q.to_euler();
        let k = dt / (dt + FOLLOW_TIME);
        Self {
            roll: self.roll + k * (roll - self.roll),
            pitch: self.pitch + k * (pitch - self.pitch),
            ..self
        }
    }

    pub fn rotors(self, thrust: f32) -> Setpoint {
        Setpoint::Resting {
            roll: self.roll,
            pitch: self.pitch,
            thrust,
        }
    }
}

/// Progress of the closing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spool {
    /// Share of the pilot's collective, 1 while closing, falling to 0.
    pub share: f32,
    /// The grip was proven: the share falls while the arms hold.
    pub down: bool,
    /// Time at share 0, s.
    pub still: f32,
    /// Time for which a chosen arm has been hopeless, s.
    pub hopeless: f32,
}

impl Spool {
    pub fn at(share: f32) -> Self {
        Self {
            share,
            down: false,
            still: 0.0,
            hopeless: 0.0,
        }
    }

    /// Setpoint at a full collective of `thrust` N. At the end of the ramp the rotors only lift: at little thrust a
    /// moment would come from single rotors and stop with a jolt.
    pub fn rotors(self, hold: PipeAttitudeHold, thrust: f32) -> Setpoint {
        let thrust = self.share * thrust;
        if self.down && self.share < LIFT_SHARE {
            Setpoint::Direct {
                wrench: Wrench {
                    thrust,
                    ..Wrench::default()
                },
            }
        } else {
            hold.rotors(thrust)
        }
    }

    pub fn stopped(self) -> bool {
        self.down && self.share <= 0.0
    }
}

/// Every chosen arm has at least [`HELD_SHARE`] of the grip pressure.
pub fn held(grip: Option<GripState>, arms: ArmChoice, p: &Params) -> bool {
    let firm = |a: &ArmGrip| a.pressure >= HELD_SHARE * p.grip_pressure && a.state != ArmState::Faulty;
    grip.is_some_and(|g| {
        g.arms
            .iter()
            .zip(arms.mask())
            .all(|(a, chosen)| !chosen || firm(a))
    })
}

/// A chosen arm may press: its tendon must pay out before the rotors pull at it.
pub fn pressed(grip: Option<GripState>, arms: ArmChoice) -> bool {
    use ArmState::{Closing, Free, Releasing};
    grip.is_none_or(|g| {
        let mut chosen = g.arms.iter().zip(arms.mask());
        chosen.any(|(a, chosen)| chosen && !matches!(a.state, Free | Closing | Releasing))
    })
}

const fn misfit(misfit: Misfit) -> Reason {
    match misfit {
        Misfit::Thickness => Reason::PipeMisfit,
        Misfit::Oblique => Reason::PipeOblique,
        Misfit::Uneven => Reason::ArmsUneven,
        Misfit::Opposed => Reason::ArmsOpposed,
    }
}

/// Reason for which the chosen arms cannot reach a hold.
pub fn hopeless(grip: Option<GripState>, arms: ArmChoice) -> Option<Reason> {
    let grip = grip?;
    let chosen = || {
        grip.arms
            .iter()
            .zip(arms.mask())
            .filter(|(_, chosen)| *chosen)
            .map(|(a, _)| a)
    };
    if let Some(arm) = chosen().find(|a| a.state == ArmState::Faulty) {
        Some(Reason::ArmFault(arm.fault))
    } else if chosen().any(|a| a.state == ArmState::ForceLimited) {
        Some(Reason::ForceLimit)
    } else {
        grip.misfit.map(misfit)
    }
}
