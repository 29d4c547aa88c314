//! On the pipe: closing, proof of grip, spooling down, holding, spooling up, opening.

use super::hold::{Hold, Spool, held, hopeless};
use super::logic::{ModeLogic, State};
use super::{Inputs, Reason};
use crate::grip_memory::GripMemory;
use crate::math::clamp;
use crate::rc::{ArmChoice, Sticks};

/// Time of the linear ramp of the collective between the pilot's throttle and nothing, s.
pub const SPOOL_TIME: f32 = 1.5;
/// Time from the end of the ramp until the rotors stand still, s: six motor time constants.
pub const STOP_TIME: f32 = 0.3;
/// Time for which the grip may lack its proof after the rotors have stopped, s.
const PROOF_TIME: f32 = 3.0;
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
        let holds = held(i.grip, hold.arms, &self.params);
        if !holds && self.slides() {
            return self.slide_off(i, GripMemory::Controlled(hold.arms));
        }

        // Without the radio there is no pilot to fly away: a poor grip is then better than none.
        if let Some(s) = sticks {
            let hope = hopeless(i.grip, hold.arms);
            spool.hopeless = if hope.is_some() && !proven {
                spool.hopeless + dt
            } else {
                0.0
            };
            let limit = self.params.clamp_timeout + if spool.down { SPOOL_ALLOWANCE } else { 0.0 };
            let cancelled = !s.perch_switch && self.perch_seen_on;
            let lost = match hope {
                _ if cancelled => Some(Reason::ClosingCancelled),
                Some(why) if spool.hopeless >= HOPELESS_TIME => Some(why),
                _ if self.since >= limit => Some(Reason::GripNotProven),
                _ => None,
            };
            match lost {
                // Held where the belly alone would not stay: a poor grip is then better than none.
                Some(_) if holds && self.leans_too_far() => self.note(Some(Reason::LeansTooFar)),
                // A vehicle that may not fly stays where its arms hold it.
                Some(_) if holds && self.dangers.line_silent() => self.note(Some(Reason::LINE_SILENT)),
                // The arms carry and the rotors may stand: these spool up first, as on a release.
                Some(why) if holds && spool.down => {
                    self.note(Some(why));
                    self.perch_seen_off = false;
                    return State::Releasing {
                        hold,
                        share: spool.share,
                        free: 0.0,
                        opening: false,
                        kept: false,
                    };
                }
                Some(why) => return self.give_up(i, GripMemory::Controlled(hold.arms), why),
                None => {}
            }
        }

        // Radio lost and battery critical: spools down slowly, without proof of grip.
        let last_resort = sticks.is_none() && self.dangers.battery_critical();
        let down = if spool.down { holds } else { proven };
        if down || last_resort {
            spool.down = true;
            spool.share = clamp(spool.share - dt / SPOOL_TIME, 0.0, 1.0);
            spool.still = if spool.share <= 0.0 { spool.still + dt } else { 0.0 };
        } else {
            if spool.down {
                self.note(Some(Reason::GripLostSpooling));
            }
            let share = clamp(spool.share + dt / SPOOL_TIME, 0.0, 1.0);
            spool = Spool {
                hopeless: spool.hopeless,
                ..Spool::at(share)
            };
        }
        if spool.still >= STOP_TIME && proven {
            return State::Perched {
                grip_memory: GripMemory::Controlled(hold.arms),
            };
        }
        if spool.still >= STOP_TIME && last_resort {
            return State::Disarmed {
                grip_memory: GripMemory::Controlled(hold.arms),
            };
        }
        if spool.still >= STOP_TIME + PROOF_TIME {
            // Holds, but not as it should: carry part of the weight again and let the loop prove it.
            spool = Spool::at(0.0);
        }
        let hold = if spool.down {
            hold.following(i, dt)
        } else {
            hold.levelled(dt)
        };
        State::Clamping { hold, spool }
    }

    pub(super) fn perched(&mut self, i: &Inputs, grip_memory: GripMemory, sticks: Option<Sticks>) -> State {
        let (Some(s), Some(arms)) = (sticks, grip_memory.arms()) else {
            return State::Perched { grip_memory };
        };
        if !s.arm_switch {
            // Rotors stay locked. The disarming gesture hands the closed vehicle over to a person.
            if self.gesture == Some(crate::arming::Gesture::Disarm) {
                self.perch_seen_on = false;
                return State::Disarmed { grip_memory };
            }
            return State::Perched { grip_memory };
        }
        let throttle_set = (RELEASE_THROTTLE_MIN..=self.params.perch_thr_max).contains(&s.throttle);
        let asked = !s.perch_switch && self.perch_seen_on && throttle_set;
        match i.motion {
            Some(m) if asked && self.dangers.landing().is_none() && !self.leans_too_far() => {
                let (roll, pitch, _) = m.q.to_euler();
                let hold = Hold { roll, pitch, arms };
                State::Releasing {
                    hold,
                    share: 0.0,
                    free: 0.0,
                    opening: false,
                    kept: matches!(grip_memory, GripMemory::HeldByGears(_)),
                }
            }
            _ => State::Perched { grip_memory },
        }
    }

    /// Arms that do not come free while the rotors pull at them: less throttle, and the tendons stay slack.
    pub(super) fn stuck(&mut self, i: &Inputs, arms: ArmChoice) -> State {
        self.note(Some(Reason::ArmsStuck));
        let (roll, pitch, _) = i.motion.map_or((0.0, 0.0, 0.0), |m| m.q.to_euler());
        State::Releasing {
            hold: Hold { roll, pitch, arms },
            share: 1.0,
            free: 0.0,
            opening: true,
            kept: false,
        }
    }

    /// Collective below which the arms are not opened, N.
    pub(super) fn release_thrust(&self) -> f32 {
        4.0 * self.params.thrust_max * RELEASE_THROTTLE_MIN
    }

    /// What the pilot should know while perched.
    pub(super) fn perch_trouble(&self, i: &Inputs, grip_memory: GripMemory) -> Option<Reason> {
        let asked = i
            .sticks
            .is_some_and(|s| !s.perch_switch && s.throttle >= RELEASE_THROTTLE_MIN);
        if i.grip.is_none() {
            Some(Reason::ClampSilent)
        } else if !self.grasps(i, grip_memory) {
            Some(Reason::GripLost)
        } else if i.sticks.is_none() {
            Some(Reason::RADIO_LOST)
        } else if i.motion.is_none() {
            Some(Reason::IMU_SILENT)
        } else if let Some(landing) = self.dangers.landing() {
            Some(landing.reason())
        } else if asked && !self.perch_seen_on {
            Some(Reason::PerchSwitchNotOn)
        } else if asked && i.sticks.is_some_and(|s| !s.arm_switch) {
            Some(Reason::ArmSwitchOff)
        } else if asked && self.leans_too_far() {
            Some(Reason::LeansTooFar)
        } else if asked {
            Some(Reason::ThrottleTooHigh)
        } else {
            None
        }
    }

    pub(super) fn releasing(
        &mut self,
        i: &Inputs,
        hold: Hold,
        (share, free, opening, kept): (f32, f32, bool, bool),
        sticks: Option<Sticks>,
        dt: f32,
    ) -> State {
        let released = opening && i.grip.is_some_and(|g| g.released);
        let free = if released { free + dt } else { 0.0 };
        if free >= FREE_TIME {
            return State::Flight;
        }
        let holds = held(i.grip, hold.arms, &self.params);
        if !holds && self.slides() || opening && self.falls() {
            return self.slide_off(i, GripMemory::Controlled(hold.arms));
        }
        let again = sticks.is_none_or(|s| s.perch_switch && self.perch_seen_off);
        let grounded = !opening && self.dangers.line_silent();
        if (again || grounded) && kept && !opening {
            // The gears hold what they held all along; the loops could only close from where the drives are not.
            return State::Perched {
                grip_memory: GripMemory::HeldByGears(hold.arms),
            };
        }
        let share = clamp(share + dt / SPOOL_TIME, 0.0, 1.0);
        // The lean may have grown since the rotors began to lift: the arms stay closed.
        let leans = !opening && share >= 1.0 && self.leans_too_far();
        if leans {
            self.note(Some(Reason::LeansTooFar));
        }
        let refused = leans || grounded;
        if (again || refused) && !released {
            // Radio lost: hold on. A later release takes a new turn of the switch.
            self.perch_seen_on = again && sticks.is_some();
            return State::Clamping {
                hold,
                spool: Spool::at(share),
            };
        }
        if self.since >= STUCK_TIME {
            self.note(Some(Reason::ArmsStuck));
        }
        State::Releasing {
            hold: hold.levelled(dt),
            share,
            free,
            opening: opening || share >= 1.0,
            kept,
        }
    }
}
