//! What goes wrong, and what is done about it.
//!
//! | trouble | on the ground | in the air | on the pipe |
//! |---|---|---|---|
//! | arm switch off | stop | stop | stop, arms stay closed |
//! | radio lost | stop | level, sink, stop on what carries | keep closing, keep the grip |
//! | inertial sensor silent | stop | stop | stop, arms stay closed |
//! | tipped over | stop | stop | stop, arms stay closed |
//! | battery critical | - | sink, the pilot still steers | reported; release refused |
//! | data-ready line silent | stop | sink, the pilot still steers | reported; release refused |

use super::logic::{ModeLogic, State};
use super::{Inputs, Reason, Setpoint, demand};
use crate::arming::Refusal;
use crate::grip_memory::GripMemory;
use crate::math::{clamp, deg};
use crate::params::Params;
use crate::rc::{StickMode, Sticks};
use crate::support::{HINT_FORCE, Held};

/// Silence of the inertial sensor after which the rotors stop, s. Control has stopped them before: this makes
/// it last.
pub const IMU_LOST_TIME: f32 = 0.05;
/// Tilt beyond which the vehicle has tipped over, rad, and the time for which it must, s.
pub const TIPPED_TILT: f32 = deg(100.0);
/// See [`TIPPED_TILT`].
pub const TIPPED_TIME: f32 = 0.5;
/// Time for which the voltage must stay below critical, s: a gust's current peak is no empty battery.
pub const BATTERY_TIME: f32 = 1.0;
/// Radio silence in the failsafe (beyond the link's own staleness) after which flight resumes by itself, s.
pub const RESUME_TIME: f32 = 1.0;
/// Roll or pitch stick by which the pilot takes over later than that, share of its travel.
pub const RESUME_STICK: f32 = 0.3;
/// Sink rate aimed at, m/s.
const SINK_RATE: f32 = 0.8;
/// Share of the weight taken off the collective to start sinking; given back as the sink rate is reached.
const SINK_SHARE: f32 = 0.15;
/// Fastest that the collective is taken away where something seems to carry the vehicle, share of the weight
/// per second. In free air the seeming support shrinks with it, and it comes back.
const PROBE_RATE: f32 = 0.5;

/// Why the failsafe acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// No frame from the receiver.
    RadioLost,
    /// The battery is at its end.
    BatteryCritical,
    /// The inertial sensor is read by the clock, its data-ready line being silent.
    LineSilent,
    /// The vehicle has left the pipe by itself and the throttle has not moved since.
    NotTakenOver,
}

impl Cause {
    /// What the pilot reads.
    pub const fn reason(self) -> Reason {
        match self {
            Self::RadioLost => Reason::RADIO_LOST,
            Self::BatteryCritical => Reason::BatteryCritical,
            Self::LineSilent => Reason::LINE_SILENT,
            Self::NotTakenOver => Reason::NotTakenOver,
        }
    }
}

/// Timers of what may go wrong in any state.
#[derive(Clone, Copy, Debug, Default)]
pub struct Dangers {
    imu: Held,
    tipped: Held,
    battery: Held,
    /// The inertial sensor's data-ready line is silent; the port has waited long enough before it said so.
    line_silent: bool,
    /// Share of the weight taken away to see whether something carries it, 0..1.
    probe: f32,
}

impl Dangers {
    pub(super) fn step(&mut self, i: &Inputs, p: &Params, dt: f32) {
        self.imu.step(i.motion.is_none(), dt);
        let tipped = i
            .motion
            .is_some_and(|m| m.q.down_in_body().z < crate::math::cos(TIPPED_TILT));
        self.tipped.step(tipped, dt);
        self.battery
            .step(i.battery.is_some_and(|v| v < p.battery_critical), dt);
        self.line_silent = i.hardware.contains(Refusal::ImuLineSilent);
    }

    pub(super) fn battery_critical(&self) -> bool {
        self.battery.time() >= BATTERY_TIME
    }

    pub(super) fn line_silent(&self) -> bool {
        self.line_silent
    }

    /// Why the vehicle must come down while the pilot still steers, and may not leave a pipe: the more pressing first.
    pub(super) fn landing(&self) -> Option<Cause> {
        if self.battery_critical() {
            Some(Cause::BatteryCritical)
        } else if self.line_silent {
            Some(Cause::LineSilent)
        } else {
            None
        }
    }

    fn stop(&self, sticks: Option<Sticks>) -> Option<Option<Reason>> {
        if sticks.is_some_and(|s| !s.arm_switch) {
            Some(None)
        } else if self.imu.time() >= IMU_LOST_TIME {
            Some(Some(Reason::IMU_SILENT))
        } else if self.tipped.time() >= TIPPED_TIME {
            Some(Some(Reason::TippedOver))
        } else {
            None
        }
    }
}

impl ModeLogic {
    /// The state for which everything is dropped, and why.
    pub(super) fn emergency(&mut self, i: &Inputs) -> Option<(State, Option<Reason>)> {
        let why = self.dangers.stop(i.sticks)?;
        let proven = i.grip.is_some_and(|g| g.proven);
        let free = i.grip.is_some_and(|g| g.released);
        let state = match self.state {
            State::Calibrating { .. } | State::Disarmed { .. } | State::Perched { .. } => return None,
            State::Releasing { opening: true, .. } if free => State::Disarmed {
                grip_memory: GripMemory::Open,
            },
            State::Releasing {
                hold,
                opening: false,
                kept: true,
                ..
            } => {
                self.perch_seen_on = false;
                State::Perched {
                    grip_memory: GripMemory::HeldByGears(hold.arms),
                }
            }
            State::Escaping(escape) if !free => {
                self.perch_seen_on = false;
                State::Disarmed {
                    grip_memory: escape.grip_memory,
                }
            }
            State::Clamping { hold, .. } | State::Releasing { hold, .. } => {
                // Opening takes a new and deliberate turn of the switch.
                self.perch_seen_on = false;
                if proven && !matches!(self.state, State::Releasing { opening: true, .. }) {
                    State::Perched {
                        grip_memory: GripMemory::Controlled(hold.arms),
                    }
                } else {
                    State::Disarmed {
                        grip_memory: GripMemory::Controlled(hold.arms),
                    }
                }
            }
            _ => State::Disarmed {
                grip_memory: GripMemory::Open,
            },
        };
        Some((state, why))
    }

    pub(super) fn failsafe(&mut self, cause: Cause, sticks: Option<Sticks>) -> State {
        // Not `resting`: a vehicle lighter or stronger than its parameters would seem carried in free air. On real
        // ground the probe takes thrust away until most of the weight is carried.
        if self.support.grounded() {
            return self.stop(Some(cause.reason()));
        }
        match (cause, sticks) {
            (Cause::RadioLost | Cause::NotTakenOver, Some(_))
                if let Some(landing) = self.dangers.landing() =>
            {
                State::Failsafe(landing)
            }
            (Cause::NotTakenOver, Some(s)) if self.takes_over(&s) => State::Flight,
            (Cause::NotTakenOver, None) => State::Failsafe(Cause::RadioLost),
            (Cause::RadioLost, Some(s)) => {
                let taken = s.roll.abs() > RESUME_STICK || s.pitch.abs() > RESUME_STICK;
                if taken || self.since <= RESUME_TIME {
                    State::Flight
                } else {
                    State::Failsafe(cause)
                }
            }
            _ => State::Failsafe(cause),
        }
    }

    /// Takes thrust away while something seems to carry the vehicle, gives it back where nothing does.
    pub(super) fn probe(&mut self, dt: f32) {
        let hint = self.state.mode() == super::Mode::Failsafe && self.support.force() > HINT_FORCE;
        let rate = match (hint, self.support.resting()) {
            (true, true) => 3.0 * PROBE_RATE,
            (true, false) => PROBE_RATE,
            (false, _) => -4.0 * PROBE_RATE,
        };
        self.dangers.probe = clamp(self.dangers.probe + rate * dt, 0.0, 1.0);
    }

    /// Level and sinking; with the radio there the pilot still steers.
    pub(super) fn descent(&self, cause: Cause, sticks: Option<Sticks>) -> Setpoint {
        let short = clamp(1.0 - self.support.sink() / SINK_RATE, 0.0, 1.0);
        let share = clamp(1.0 - SINK_SHARE * short - self.dangers.probe, 0.0, 1.0);
        let thrust = share * self.support.weight();
        let steer = sticks.filter(|_| cause != Cause::RadioLost);
        let steer = Sticks {
            stick_mode: StickMode::Angle,
            ..steer.unwrap_or_default()
        };
        match demand::from_sticks(&steer, &self.params) {
            Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                ..
            } => Setpoint::Angle {
                roll,
                pitch,
                yaw_rate,
                thrust,
            },
            other => other,
        }
    }
}
