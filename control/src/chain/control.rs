//! Third stage: attitude and rate loop, which of them runs, and what is kept of them when that changes.

#[cfg(test)]
mod tests;

use crate::attitude::{AttitudeLoop, AttitudeSetpoint, Target};
use crate::chain::{Attitude, CONTROL_RATE_HZ, Demand};
use crate::math;
use crate::params::Params;
use crate::rate::{Feedback, RateLoop};
use crate::setpoint::Setpoint;
use crate::vector::Vec3;
use crate::wrench::Wrench;

/// Largest share of a rotor's thrust that roll and pitch may each add or take while resting on the pipe.
const RESTING_SHARE: f32 = 0.4;

/// A setpoint, and when it was given.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// What the rotors are to do; [`Setpoint::Stop`] in place of one that is stale.
    pub setpoint: Setpoint,
    /// When it was given, µs. A direction is aimed at once for each time: that takes as long as half a step.
    pub at_us: u64,
}

/// Which loops a setpoint runs.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    None,
    Attitude,
    /// The same, as the vehicle leaves the pipe by itself.
    Escape,
    Rate,
    Direct,
}

impl Kind {
    #[inline(always)]
    const fn of(setpoint: &Setpoint) -> Self {
        match setpoint {
            Setpoint::Stop | Setpoint::Idle | Setpoint::Spin(_) => Self::None,
            Setpoint::Angle { .. } | Setpoint::Resting { .. } => Self::Attitude,
            Setpoint::Escape { .. } => Self::Escape,
            Setpoint::Rate { .. } => Self::Rate,
            Setpoint::Direct { .. } => Self::Direct,
        }
    }

    /// The attitude loop runs.
    const fn turns(self) -> bool {
        matches!(self, Self::Attitude | Self::Escape)
    }

    /// The rate loop runs.
    const fn integrates(self) -> bool {
        self.turns() || matches!(self, Self::Rate)
    }
}

/// Both loops with their switching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// From setpoints to rates.
    pub attitude: AttitudeLoop,
    /// From rates to moments.
    pub rate: RateLoop,
    /// Sideways and fore-aft lever of a rotor, m.
    levers: [f32; 2],
    kind: Kind,
    /// When what the attitude loop aims at was given, µs.
    aimed: Option<u64>,
}

impl Control {
    /// Loops at rest.
    pub fn new(p: &Params) -> Self {
        Self {
            attitude: AttitudeLoop::new(p),
            rate: RateLoop::new(p, CONTROL_RATE_HZ),
            levers: [p.arm_d, p.arm_b],
            kind: Kind::None,
            aimed: None,
        }
    }

    /// What the attitude loop aims at.
    #[inline]
    pub const fn target(&self) -> Target {
        self.attitude.target()
    }

    /// The demand that leads from `a` to `command`; `feedback` is what the last mix gave.
    // On its own: not for size with its caller.
    #[inline(never)]
    pub fn step(&mut self, a: &Attitude, command: &Command, feedback: &Feedback) -> Demand {
        let kind = Kind::of(&command.setpoint);
        if kind != self.kind {
            self.change_to(kind, a);
        }
        if feedback.yaw_gated {
            self.attitude.capture_heading(a.q);
        }
        let (wanted, thrust, resting) = match command.setpoint {
            Setpoint::Stop => return Demand::Stop,
            Setpoint::Idle => return Demand::Idle,
            Setpoint::Spin(spin) => return Demand::Spin(spin),
            Setpoint::Direct { wrench } => return Demand::Wrench(wrench),
            Setpoint::Rate { rate, thrust } => (rate, thrust, false),
            Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                thrust,
            }
            | Setpoint::Escape {
                roll,
                pitch,
                yaw_rate,
                thrust,
            } => {
                let angle = AttitudeSetpoint {
                    roll,
                    pitch,
                    yaw_rate,
                };
                (self.turn(a, angle, command.at_us), thrust, false)
            }
            Setpoint::Resting { roll, pitch, thrust } => {
                let angle = AttitudeSetpoint {
                    roll,
                    pitch,
                    yaw_rate: 0.0,
                };
                (self.turn(a, angle, command.at_us), thrust, true)
            }
        };
        let moment = self.rate.step(wanted, a.rate, *feedback, !resting, a.dt);
        if resting {
            Demand::Resting(self.while_resting(moment, thrust))
        } else {
            Demand::Wrench(Wrench {
                thrust,
                roll: moment.x,
                pitch: moment.y,
                yaw: moment.z,
            })
        }
    }

    /// A loop is reset on activation, at the vehicle's attitude: its state is stale.
    #[cold]
    fn change_to(&mut self, kind: Kind, a: &Attitude) {
        if kind.turns() && !self.kind.turns() {
            self.attitude.reset(a.q);
            self.aimed = None;
        }
        let lasts = kind.integrates() && self.kind.integrates();
        // What the integrals hold on the pipe was wound up against it: in the air it would throw the vehicle to that side.
        if !lasts || kind == Kind::Escape {
            self.rate.reset();
        }
        self.kind = kind;
    }

    /// Rates that lead to `angle`, given at `at_us` µs.
    #[inline(always)]
    fn turn(&mut self, a: &Attitude, angle: AttitudeSetpoint, at_us: u64) -> Vec3 {
        if self.aimed != Some(at_us) {
            self.attitude.aim(angle);
            self.aimed = Some(at_us);
        }
        self.attitude.step(a.q, a.dt)
    }

    /// Moments fade with the thrust, so that rotors which spool down stop alike: whatever differs between them at the end
    /// vanishes faster than the tendons can follow.
    #[inline(always)]
    fn while_resting(&self, moment: Vec3, thrust: f32) -> Wrench {
        let [roll_max, pitch_max] = self.levers.map(|lever| RESTING_SHARE * thrust * lever);
        Wrench {
            thrust,
            roll: math::clamp_abs(moment.x, roll_max),
            pitch: math::clamp_abs(moment.y, pitch_max),
            yaw: 0.0,
        }
    }
}
