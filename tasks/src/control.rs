//! Attitude and rate control, one step for each attitude.
//!
//! Flight level. Deadline: 400 µs after data-ready. Without a fresh setpoint the rotors stop.

use embassy_time::{Duration, Instant};
use sophie_control::attitude::{AttitudeLoop, AttitudeSetpoint};
use sophie_control::math;
use sophie_control::rate::{Feedback, RateLoop};
use sophie_control::vector::Vec3;
use sophie_control::wrench::Wrench;

use crate::deadline::{TaskId, record_run};
use crate::imu::CONTROL_RATE_HZ;
use crate::links::{Attitude, Demand, Links, Setpoint};

/// Time from data-ready to the demand.
pub const DEADLINE: Duration = Duration::from_micros(400);

/// Runs both loops at 1 kHz; returns only if the link has no receiver left.
pub async fn run(links: &Links) {
    let Some(mut attitude) = links.attitude.receiver() else {
        return;
    };
    let mut loops = Loops {
        attitude: AttitudeLoop::new(&links.params),
        rate: RateLoop::new(&links.params, CONTROL_RATE_HZ),
        levers: [links.params.arm_d, links.params.arm_b],
        kind: Kind::None,
        escapes: false,
        aimed: None,
    };
    loop {
        let estimate = attitude.changed().await;
        let started = Instant::now();
        let setpoint = links.setpoint.latest();
        let asked = setpoint.map(|message| message.at);
        let setpoint = setpoint
            .and_then(|message| message.fresh_at(started, links.setpoint.stale_after))
            .unwrap_or(Setpoint::Stop);
        let feedback = links.mix.fresh_to(started, |mix| Feedback {
            roll_pitch: mix.given.roll_pitch,
            yaw: mix.given.yaw,
            yaw_gated: mix.yaw_gated,
        });
        let feedback = feedback.unwrap_or(NOTHING_GIVEN);
        let demand = loops.step(&estimate.value, setpoint, asked, feedback);
        links.demand.send(estimate.at, demand);
        links.target.send(estimate.at, loops.attitude.target());
        record_run(links, TaskId::Control, estimate.at, started, DEADLINE);
    }
}

/// Largest share of a rotor's thrust that roll and pitch may each add or take while resting on the pipe.
const RESTING_SHARE: f32 = 0.4;

const NOTHING_GIVEN: Feedback = Feedback {
    roll_pitch: 0.0,
    yaw: 0.0,
    yaw_gated: true,
};

/// Which loops a setpoint runs.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    None,
    Attitude,
    Rate,
    Direct,
}

impl Kind {
    fn of(setpoint: Setpoint) -> Self {
        match setpoint {
            Setpoint::Stop | Setpoint::Idle => Self::None,
            Setpoint::Angle { .. } | Setpoint::Escape { .. } | Setpoint::Resting { .. } => Self::Attitude,
            Setpoint::Rate { .. } => Self::Rate,
            Setpoint::Direct { .. } => Self::Direct,
        }
    }
}

struct Loops {
    attitude: AttitudeLoop,
    rate: RateLoop,
    /// Sideways and fore-aft lever of a rotor, m.
    levers: [f32; 2],
    kind: Kind,
    /// The vehicle leaves the pipe by itself.
    escapes: bool,
    /// When what the attitude loop aims at was asked for.
    aimed: Option<Instant>,
}

impl Loops {
    /// Rates that lead to `angle`, asked for at `asked`. Only a new one is aimed at: that takes as long as half a step.
    fn turn(&mut self, a: &Attitude, angle: AttitudeSetpoint, asked: Option<Instant>) -> Vec3 {
        if self.aimed != asked {
            self.attitude.aim(angle);
            self.aimed = asked;
        }
        self.attitude.step(a.q, a.dt)
    }

    /// `asked` is when `setpoint` was.
    fn step(
        &mut self,
        a: &Attitude,
        setpoint: Setpoint,
        asked: Option<Instant>,
        feedback: Feedback,
    ) -> Demand {
        // A loop is reset on activation, at the vehicle's attitude: its state is stale.
        let kind = Kind::of(setpoint);
        if kind != self.kind {
            if kind == Kind::Attitude {
                self.attitude.reset(a.q);
                self.aimed = None;
            }
            if !matches!(
                (self.kind, kind),
                (Kind::Attitude, Kind::Rate) | (Kind::Rate, Kind::Attitude)
            ) {
                self.rate.reset();
            }
            self.kind = kind;
        }
        let escapes = matches!(setpoint, Setpoint::Escape { .. });
        if escapes && !self.escapes {
            // What the integrals hold was wound up against the pipe: in the air it would throw the vehicle to that side.
            self.rate.reset();
        }
        self.escapes = escapes;
        if feedback.yaw_gated {
            self.attitude.capture_heading(a.q);
        }
        let (wanted, thrust, resting) = match setpoint {
            Setpoint::Stop => return Demand::Stop,
            Setpoint::Idle => return Demand::Idle,
            Setpoint::Direct { wrench } => return Demand::Wrench { wrench, yaw: true },
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
                (self.turn(a, angle, asked), thrust, false)
            }
            Setpoint::Resting { roll, pitch, thrust } => {
                let angle = AttitudeSetpoint {
                    roll,
                    pitch,
                    yaw_rate: 0.0,
                };
                (self.turn(a, angle, asked), thrust, true)
            }
        };
        let Vec3 {
            x: roll,
            y: pitch,
            z: yaw,
        } = self.rate.step(wanted, a.rate, feedback, !resting, a.dt);
        if resting {
            // Moments fade with the thrust, so that rotors which spool down stop alike: whatever differs
            // between them at the end vanishes faster than the tendons can follow.
            let [roll_max, pitch_max] = self.levers.map(|lever| RESTING_SHARE * thrust * lever);
            let (roll, pitch) = (math::clamp_abs(roll, roll_max), math::clamp_abs(pitch, pitch_max));
            return Demand::Wrench {
                wrench: Wrench {
                    thrust,
                    roll,
                    pitch,
                    yaw: 0.0,
                },
                yaw: false,
            };
        }
        Demand::Wrench {
            wrench: Wrench {
                thrust,
                roll,
                pitch,
                yaw,
            },
            yaw: true,
        }
    }
}
