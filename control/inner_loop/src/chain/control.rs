//! Third stage, 1 kHz: attitude and rate loop, and their switching.

#[cfg(test)]
mod tests;

use super::messages::Demand;
use super::step_clock::CONTROL_RATE_HZ;
use crate::allocation::wrench::Wrench;
use crate::attitude::attitude_loop::{AttitudeLoop, AttitudeSetpoint, Target};
use crate::attitude::gains::Gains;
use crate::attitude::messages::Attitude;
use crate::attitude::rate_loop::{Feedback, RateLoop};
use crate::chain::setpoint::Setpoint;
use crate::maths::scalar;
use crate::maths::vector::Vec3;
use crate::params::Params;

/// Largest share of a rotor's thrust for roll and for pitch on the pipe.
const RESTING_SHARES: [f32; 2] = [0.6, 0.4];

/// A setpoint and its time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Command {
    /// Wanted motion of the rotors; [`Setpoint::Stop`] replaces a stale one.
    pub setpoint: Setpoint,
    /// Its time, µs. Each is aimed at only once, which takes as long as half a step.
    pub at_us: u64,
    /// The vehicle swings by itself: roll and pitch slower.
    pub gentle: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    None,
    Attitude,
    /// Attitude loop while the vehicle leaves the pipe by itself.
    Escape,
    Rate,
    Direct,
}

impl Kind {
    #[inline(always)]
    const fn of(setpoint: &Setpoint) -> Self {
        match setpoint {
            Setpoint::Stop | Setpoint::Idle | Setpoint::Spin(_) | Setpoint::StaticThrust(_) => Self::None,
            Setpoint::Angle { .. } | Setpoint::Resting { .. } => Self::Attitude,
            Setpoint::Escape { .. } => Self::Escape,
            Setpoint::Rate { .. } => Self::Rate,
            Setpoint::Direct { .. } => Self::Direct,
        }
    }

    const fn turns(self) -> bool {
        matches!(self, Self::Attitude | Self::Escape)
    }

    const fn integrates(self) -> bool {
        self.turns() || matches!(self, Self::Rate)
    }
}

/// Both loops and their switching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Control {
    /// Attitude loop.
    pub attitude: AttitudeLoop,
    /// Rate loop.
    pub rate: RateLoop,
    /// Sideways and fore-aft lever of a rotor, m.
    levers: [f32; 2],
    kind: Kind,
    /// Time of the setpoint aimed at, µs.
    aimed: Option<u64>,
    /// Gains of roll and pitch, and gentle ones.
    gains: [Gains; 2],
    gentle: bool,
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
            gains: [Gains::of(p), Gains::gentle(p)],
            gentle: false,
        }
    }

    /// Target of the attitude loop.
    #[inline]
    pub const fn target(&self) -> Target {
        self.attitude.target()
    }

    /// Demand that leads from `a` to `command`; `feedback` comes from the last mix.
    // Not inlined: its caller is built for size.
    #[inline(never)]
    pub fn step(&mut self, a: &Attitude, command: &Command, feedback: &Feedback) -> Demand {
        let kind = Kind::of(&command.setpoint);
        if kind != self.kind {
            self.change_to(kind, a);
        }
        if command.gentle != self.gentle {
            self.change_pace(command.gentle);
        }
        if feedback.yaw_gated {
            self.attitude.capture_heading(a.q);
        }
        let (wanted, thrust, resting) = match command.setpoint {
            Setpoint::Stop => return Demand::Stop,
            Setpoint::Idle => return Demand::Idle,
            Setpoint::Spin(spin) => return Demand::Spin(spin),
            Setpoint::StaticThrust(test) => return Demand::StaticThrust(test),
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

    /// Resets a loop on activation: its state is stale.
    #[cold]
    fn change_to(&mut self, kind: Kind, a: &Attitude) {
        if kind.turns() && !self.kind.turns() {
            self.attitude.reset(a.q);
            self.aimed = None;
        }
        let lasts = kind.integrates() && self.kind.integrates();
        // Integrals wound up against the pipe would throw the vehicle in the air.
        if !lasts || kind == Kind::Escape {
            self.rate.reset();
        }
        self.kind = kind;
    }

    #[cold]
    fn change_pace(&mut self, gentle: bool) {
        let [usual, slow] = &self.gains;
        let gains = if gentle { slow } else { usual };
        self.attitude.change(gains);
        self.rate.change(gains);
        self.gentle = gentle;
    }

    /// Rates towards `angle`, given at `at_us` µs.
    #[inline(always)]
    fn turn(&mut self, a: &Attitude, angle: AttitudeSetpoint, at_us: u64) -> Vec3 {
        if self.aimed != Some(at_us) {
            self.attitude.aim(angle);
            self.aimed = Some(at_us);
        }
        self.attitude.step(a.q, a.dt)
    }

    /// Limits moments in proportion to the thrust, so that spooling-down rotors stop alike: their difference vanishes
    /// faster than the tendons follow.
    #[inline(always)]
    fn while_resting(&self, moment: Vec3, thrust: f32) -> Wrench {
        let ([roll, pitch], [sideways, ahead]) = (RESTING_SHARES, self.levers);
        let (roll_max, pitch_max) = (roll * thrust * sideways, pitch * thrust * ahead);
        Wrench {
            thrust,
            roll: scalar::clamp_abs(moment.x, roll_max),
            pitch: scalar::clamp_abs(moment.y, pitch_max),
            yaw: 0.0,
        }
    }
}
