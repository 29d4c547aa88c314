//! On the pipe: closing, proof of grip, spooling down, holding, spooling up, opening.

use super::logic::{ModeLogic, State};
use super::{Grip, Inputs, Rotors};
use crate::grip::{ArmGrip, ArmState};
use crate::math::{clamp, clamp_abs};
use crate::params::Params;
use crate::rc::{ArmChoice, Sticks};

/// Time of the linear ramp of the collective between the pilot's throttle and nothing, s.
pub const SPOOL_TIME: f32 = 1.5;
/// Time from the end of the ramp until the rotors stand still, s: six motor time constants.
pub const STOP_TIME: f32 = 0.3;
/// Speed at which a lean at contact is taken out, rad/s.
const LEVEL_RATE: f32 = 0.2;
/// Time constant with which the attitude held follows the present one while the rotors spool down, s.
const FOLLOW_TIME: f32 = 0.2;
/// Time for which the grip may lack its proof after the rotors have stopped, s.
const PROOF_TIME: f32 = 3.0;
/// Share of the grip pressure above which an arm still holds, though not within the tolerance: the load
/// moves from the rotors onto the arms while they spool down.
const HELD_SHARE: f32 = 0.6;
/// Time for which a chosen arm may be at its force limit, or faulty, before the closing is given up, s.
pub const HOPELESS_TIME: f32 = 1.0;
/// Time beyond `clamp_timeout` for spooling down and proving the grip, s.
const SPOOL_ALLOWANCE: f32 = 10.0;
/// Least throttle at which the arms are opened: some of the weight is carried when they let go.
pub const RELEASE_THROTTLE_MIN: f32 = 0.2;
/// Least throttle kept while the arms open or close again, whatever the stick does.
pub(super) const CLOSE_AGAIN: f32 = RELEASE_THROTTLE_MIN;
/// Time for which every arm must be free before flight, s.
pub const FREE_TIME: f32 = 0.3;
/// Time after which arms that do not come free are reported, s.
const STUCK_TIME: f32 = 10.0;

/// The attitude held on the pipe and the arms that close.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Roll at contact, rad.
    pub roll: f32,
    /// Pitch at contact, rad.
    pub pitch: f32,
    /// The arms chosen at contact; the switch is not read again until they are free.
    pub arms: ArmChoice,
}

impl Hold {
    /// One step of levelling the roll. The crown of a pipe is an unstable seat: a lean that is merely held
    /// grows as the rotors give the weight back. Pitch stays: it is the slope of the pipe.
    pub(super) fn levelled(self, dt: f32) -> Self {
        Self { roll: self.roll - clamp_abs(self.roll, LEVEL_RATE * dt), ..self }
    }

    /// One step of following the present attitude: what the grip holds the rotors need not, and what they do
    /// not do any more cannot end with a jolt when they stop.
    fn following(self, i: &Inputs, dt: f32) -> Self {
        let Some(motion) = i.motion else {
            return self;
        };
        let (roll, pitch, _) = motion.q.to_euler();
        let k = dt / (dt + FOLLOW_TIME);
        Self { roll: self.roll + k * (roll - self.roll), pitch: self.pitch + k * (pitch - self.pitch), ..self }
    }

    /// Resting with a collective of `thrust` N.
    pub fn rotors(self, thrust: f32) -> Rotors {
        Rotors::Resting {
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
    /// The grip was proven: the share falls as long as the arms hold.
    pub down: bool,
    /// Time at share 0, s.
    pub still: f32,
    /// Time for which a chosen arm has been hopeless, s.
    pub hopeless: f32,
}

impl Spool {
    /// Closing with this share of the collective.
    pub fn at(share: f32) -> Self {
        Self {
            share,
            down: false,
            still: 0.0,
            hopeless: 0.0,
        }
    }

    /// The rotors are to stand still.
    pub fn stopped(self) -> bool {
        self.down && self.share <= 0.0
    }
}

/// Every chosen arm presses the pipe with a good part of the grip pressure.
fn held(grip: Option<Grip>, arms: ArmChoice, p: &Params) -> bool {
    let firm = |a: &ArmGrip| a.pressure >= HELD_SHARE * p.grip_pressure && a.state != ArmState::Faulty;
    grip.is_some_and(|g| {
        g.arms
            .iter()
            .zip(arms.mask())
            .all(|(a, chosen)| !chosen || firm(a))
    })
}

/// Why a chosen arm will never hold.
fn hopeless(grip: Option<Grip>, arms: ArmChoice) -> Option<&'static str> {
    let grip = grip?;
    let any = |s| {
        grip.arms
            .iter()
            .zip(arms.mask())
            .any(|(a, chosen)| chosen && a.state == s)
    };
    if any(ArmState::Faulty) {
        Some("pressure sensor fault")
    } else if any(ArmState::ForceLimited) {
        Some("force limit reached without grip")
    } else {
        None
    }
}

impl ModeLogic {
    pub(super) fn clamping(
        &mut self,
        i: &Inputs,
        hold: Hold,
        mut spool: Spool,
        sticks: Option<Sticks>,
        dt: f32,
    ) -> State {
        let proven = i.grip.is_some_and(|g| g.proven);
        let give_up = State::Releasing {
            hold,
            share: spool.share,
            free: 0.0,
            opening: false,
        };

        // Without the radio nobody could fly away: a poor grip is then better than none.
        if let Some(s) = sticks {
            if !s.perch_switch && self.perch_seen_on {
                self.note("closing cancelled");
                return give_up;
            }
            let hope = hopeless(i.grip, hold.arms);
            spool.hopeless = if hope.is_some() && !proven {
                spool.hopeless + dt
            } else {
                0.0
            };
            let limit = self.params.clamp_timeout + if spool.down { SPOOL_ALLOWANCE } else { 0.0 };
            let lost = match hope {
                Some(why) if spool.hopeless >= HOPELESS_TIME => Some(why),
                _ if self.since >= limit => Some("grip not proven in time"),
                _ => None,
            };
            if let Some(why) = lost {
                self.note(why);
                self.perch_seen_off = false;
                return give_up;
            }
        }

        // Nobody could fly away and the rotors are about to stop anyway: down slowly, on whatever grip there is.
        let last_resort = sticks.is_none() && self.dangers.battery_critical();
        let down = if spool.down {
            held(i.grip, hold.arms, &self.params)
        } else {
            proven
        };
        if down || last_resort {
            spool.down = true;
            spool.share = clamp(spool.share - dt / SPOOL_TIME, 0.0, 1.0);
            spool.still = if spool.share <= 0.0 { spool.still + dt } else { 0.0 };
        } else {
            if spool.down {
                self.note("grip lost while spooling down");
            }
            let share = clamp(spool.share + dt / SPOOL_TIME, 0.0, 1.0);
            spool = Spool {
                hopeless: spool.hopeless,
                ..Spool::at(share)
            };
        }
        if spool.still >= STOP_TIME && proven {
            return State::Perched { arms: hold.arms };
        }
        if spool.still >= STOP_TIME && last_resort {
            return State::Disarmed {
                closed: Some(hold.arms),
            };
        }
        if spool.still >= STOP_TIME + PROOF_TIME {
            // Holds, but not as it should: carry part of the weight again and let the loop prove it.
            spool = Spool::at(0.0);
        }
        let hold = if spool.down { hold.following(i, dt) } else { hold.levelled(dt) };
        State::Clamping { hold, spool }
    }

    pub(super) fn perched(&mut self, i: &Inputs, arms: ArmChoice, sticks: Option<Sticks>) -> State {
        let Some(s) = sticks else {
            return State::Perched { arms };
        };
        if !s.arm_switch {
            // Rotors stay locked. The disarming gesture hands the closed vehicle over to a person.
            if self.gesture == Some(crate::arming::Gesture::Disarm) {
                self.perch_seen_on = false;
                return State::Disarmed { closed: Some(arms) };
            }
            return State::Perched { arms };
        }
        let throttle_set = (RELEASE_THROTTLE_MIN..=self.params.perch_throttle_max).contains(&s.throttle);
        let asked = !s.perch_switch && self.perch_seen_on && throttle_set;
        match i.motion {
            Some(m) if asked && !self.dangers.battery_critical() => {
                let (roll, pitch, _) = m.q.to_euler();
                let hold = Hold { roll, pitch, arms };
                State::Releasing {
                    hold,
                    share: 0.0,
                    free: 0.0,
                    opening: false,
                }
            }
            _ => State::Perched { arms },
        }
    }

    /// What the pilot should know while perched.
    pub(super) fn perch_trouble(&self, i: &Inputs, arms: ArmChoice) -> Option<&'static str> {
        let asked = i
            .sticks
            .is_some_and(|s| !s.perch_switch && s.throttle >= RELEASE_THROTTLE_MIN);
        if i.grip.is_none() {
            Some("clamp loop silent")
        } else if !held(i.grip, arms, &self.params) {
            Some("grip lost")
        } else if i.sticks.is_none() {
            Some("radio lost")
        } else if i.motion.is_none() {
            Some("inertial sensor silent")
        } else if self.dangers.battery_critical() {
            Some("battery critical")
        } else if asked && !self.perch_seen_on {
            Some("turn perch switch on first")
        } else if asked && i.sticks.is_some_and(|s| !s.arm_switch) {
            Some("arm switch off")
        } else if asked {
            Some("throttle too high to release")
        } else {
            None
        }
    }

    pub(super) fn releasing(
        &mut self,
        i: &Inputs,
        hold: Hold,
        (share, free, opening): (f32, f32, bool),
        sticks: Option<Sticks>,
        dt: f32,
    ) -> State {
        let released = opening && i.grip.is_some_and(|g| g.released);
        let free = if released { free + dt } else { 0.0 };
        if free >= FREE_TIME {
            return State::Flight;
        }
        let again = sticks.is_none_or(|s| s.perch_switch && self.perch_seen_off);
        if again && !released {
            // Radio lost: hold on. A later release takes a new turn of the switch.
            self.perch_seen_on = sticks.is_some();
            return State::Clamping {
                hold,
                spool: Spool::at(share),
            };
        }
        let share = clamp(share + dt / SPOOL_TIME, 0.0, 1.0);
        if self.since >= STUCK_TIME {
            self.note("arms do not come free");
        }
        State::Releasing {
            hold,
            share,
            free,
            opening: opening || share >= 1.0,
        }
    }
}
