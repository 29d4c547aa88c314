//! Conditions of the transitions, with their names in the printed table.

use crate::arming::Gesture;
use crate::contact::contact_force::HINT_FORCE;
use crate::gripper::retained_grip::GripMemory;
use crate::mode::context::Step;
use crate::mode::reason::Reason;
use crate::mode::state::State;
use crate::mode::states::approach::{self, Approach};
use crate::mode::states::clamping::Clamping;
use crate::mode::states::contact::{CONTACT_MARGIN, CONTACT_TIME};
use crate::mode::states::escaping::{TAKE_OVER_TIME, takes_over};
use crate::mode::states::failsafe::{RESUME_STICK, RESUME_TIME};
use crate::mode::states::flight::Flight;
use crate::mode::states::perched::Perched;
use crate::mode::states::releasing::{FREE_TIME, Releasing};
use crate::pilot::rc::Sticks;
use crate::pilot::stick_positions::{self, centred};

/// A condition of a transition.
#[derive(Clone, Copy, Debug)]
pub struct Guard {
    /// Printed in the table of the docs.
    #[cfg(test)]
    pub name: &'static str,
    /// True if it holds in this state and step.
    pub holds: fn(&State, &Step<'_>) -> bool,
}

/// Declares guards: name, text, condition.
macro_rules! guards {
    ($($name:ident = $text:literal, $holds:expr;)+) => {
        $(pub const $name: Guard = Guard {
            #[cfg(test)]
            name: $text,
            holds: $holds,
        };)+
    };
}

guards! {
    ARM_SWITCH_OFF = "arm switch off, or a forced disarming", |_, s| {
        s.context.remote.kill || sticks(s, |s| !s.arm_switch)
    };
    IMU_SILENT = "inertial sensor silent", |_, s| s.context.dangers.imu_silent();
    TIPPED_OVER = "tipped over", |_, s| s.context.dangers.tipped_over();
    MUST_LAND = "battery critical or not measured, or data-ready line silent", |_, s| s.context.dangers.landing().is_some();
    LINE_SILENT = "data-ready line silent", |_, s| s.context.dangers.line_silent();
    MAY_FLY = "nothing forces a landing", |_, s| s.context.dangers.landing().is_none();
    RADIO_LOST = "radio lost", |_, s| s.inputs.sticks.is_none();
    RADIO = "radio there", |_, s| s.inputs.sticks.is_some();

    CALIBRATED = "calibrated", |_, s| s.inputs.motion.is_some_and(|m| m.calibrated);
    ARM_GESTURE = "arming gesture, or an order", |_, s| s.context.gesture == Some(Gesture::Arm);
    DISARM_GESTURE = "disarming gesture, or an order", |_, s| s.context.gesture == Some(Gesture::Disarm);
    CHECKS_PASS = "every arming check passes", |state, s| s.context.inhibits(s.inputs, at_rest(state, s)).is_empty();
    ARMS_CLOSED = "arms closed", |state, s| at_rest(state, s).arms().is_some();
    THROTTLE_UP = "throttle not low", |_, s| sticks(s, |t| t.throttle > s.context.params.throttle_low);
    THROTTLE_LOW = "throttle low", |_, s| sticks(s, |t| t.throttle <= s.context.params.throttle_low);
    IDLED = "idle for too long", |_, s| s.context.since >= crate::mode::states::armed::IDLE_MAX;
    STOOD = "landed long enough", |_, s| s.context.since >= crate::mode::states::landed::LANDED_TIME;
    GROUNDED = "the ground carries nearly all", |_, s| s.context.contact_force.grounded();

    HOLD_ON = "hold switch on, sticks in angle mode, perch switch off", |_, s| sticks(s, stick_positions::asks_hold);
    HOLD_OFF = "hold switch off, or sticks in another mode", |_, s| sticks(s, |t| !stick_positions::keeps_hold(t));
    HOLD_KEPT = "hold switch on, sticks in angle mode", |_, s| sticks(s, stick_positions::keeps_hold);
    HOLD_TURNED = "hold switch was off since the last try", |_, s| s.context.hold_seen_off;
    POSITION_FRESH = "position known", |_, s| s.inputs.position_fresh();
    MOTORS_FOLLOW = "motors fast enough", |_, s| s.context.motors_follow();
    POSITION_LOST = "position lost for too long", |_, s| s.inputs.position_lost();

    SWINGS = "swings", |_, s| s.context.oscillation.swings();
    HAS_SWUNG = "has swung before", |_, s| s.context.has_swung;
    POSITION_ADRIFT = "position stale", |_, s| s.inputs.position_adrift();
    POSITION_AWAITED = "position awaited for too long", |_, s| s.inputs.position_awaited();

    ASKED_TO_PERCH = "perch switch turned on", |_, s| approach::asked(s);
    SERVOS_FED = "servo battery, if measured, not low", |_, s| s.inputs.servo_trouble().is_none();
    MAY_APPROACH = "position, thrust and range or pipe known, sticks centred, servo battery not low", |_, s| approach::obstacle(s).is_none();
    TAKEN_OVER = "a stick moved, or perch or hold switch turned", |_, s| s.context.auto_perch.taken;
    AUTO_PERCH = "perching or leaving by itself", |_, s| s.context.auto_perch.active;
    BY_HAND = "flown by hand", |_, s| !s.context.auto_perch.acts();
    TRY_LEFT = "another try is left", |_, s| s.context.auto_perch.may_try();
    DEPARTING = "leaving by itself", |_, s| s.context.auto_perch.acts() && s.context.auto_perch.leaving;
    DEPARTED = "climbed off the pipe", |state, _| approaching(state, Approach::has_left);
    APPROACH_ABORTED = "no other try", |state, _| approaching(state, |a| a.abort_reason.is_some());
    FEELS_PIPE = "on the way down, and something seems to carry it", |state, s| {
        approaching(state, Approach::committed) && s.context.contact_force.force() > HINT_FORCE
    };
    ABORTED_IN_CONTACT = "a try ends while something seems to carry it", |state, _| approaching(state, Approach::aborted_in_contact);
    NOT_COMMITTED = "nothing below by what it sees", |state, _| approaching(state, Approach::not_committed);
    COMMITTED = "on the way down", |state, _| approaching(state, Approach::committed);
    AUTO_RELEASE = "perch switch off again, hold switch on, sticks centred, perched by itself", |_, s| {
        let sticks_ask = |t: &Sticks| t.arm_switch && !t.perch_switch && stick_positions::keeps_hold(t) && centred(t);
        s.context.auto_perch.active && s.context.perch_switch.seen_on && sticks(s, sticks_ask)
    };

    MEANS_TO_PERCH = "perch switch on, throttle down", |_, s| Flight::means_to_perch(s);
    SETS_DOWN = "perch switch on or just turned off, throttle down", |_, s| Flight::sets_down(s);
    SWITCH_TURNED = "perch switch was off since the last try", |_, s| s.context.perch_switch.seen_off;
    FALLS_BESIDE = "falls, leaning where no touch would be held", |_, s| {
        s.context.fall.falls() && s.context.lean.beyond_seats()
    };
    SLIDES_AT_TOUCH = "leans where it feels the pipe", |_, s| s.context.lean.slides_at_touch();
    TOUCHED = "feels the pipe", |_, s| s.context.contact_force.touched();
    LIFTED = "nothing carries it any more", |_, s| s.context.contact_force.lifted();
    LEVEL = "nearly level", |_, s| Flight::is_level(s);
    CALLED_OFF = "perch switch off or throttle up", |_, s| {
        let most = s.context.params.perch_thr_max + CONTACT_MARGIN;
        sticks(s, |s| !s.perch_switch || s.throttle > most)
    };
    SLIDES = "slides", |_, s| s.context.lean.slides();
    CREEPS = "leans more and more", |_, s| s.context.lean.creeps();
    TWISTS = "turns on its pads", |_, s| s.context.lean.twists();
    NOT_RESTING = "nothing carries", |_, s| !s.context.contact_force.resting();
    RESTED = "rested long enough", |_, s| s.context.since >= CONTACT_TIME && s.context.contact_force.resting();

    ARMS_STAY = "arms hold and have not opened", |state, s| match state {
        State::Clamping(_) => s.grip_proven(),
        State::Releasing(r) => !r.opening && (r.kept || s.grip_proven()),
        _ => false,
    };
    LOOSE = "arms do not hold", |state, s| match state {
        State::Clamping(c) => !c.holds(s),
        State::Releasing(r) => !r.holds(s),
        _ => true,
    };
    UNPROVEN = "grip not proven yet", |state, s| closing(state, |c| !c.spool.down && !s.grip_proven());
    DOUBT = "the closing should end", |state, s| closing(state, |c| c.doubt(s).is_some());
    MAY_LEAVE = "nothing keeps it there", |state, s| closing(state, |c| c.must_stay(s).is_none());
    SPOOLED_ON_GRIP = "arms hold and rotors spool down", |state, s| closing(state, |c| c.holds(s) && c.spool.down);
    STANDS = "rotors stand", |state, s| closing(state, |c| c.stands(s));
    GRIP_PROVEN = "grip proven", |_, s| s.grip_proven();
    LAST_RESORT = "radio lost, and battery critical or not measured", |_, s| Clamping::last_resort(s);

    RELEASE_ASKED = "perch switch off again, throttle set", |_, s| Perched::release_asked(s);
    UPRIGHT = "attitude known, lean small", |_, s| s.inputs.motion.is_some() && !s.context.lean.too_far_to_release();

    SLIPPED = "arms were tightened", |_, s| s.context.tightened > 0;
    GIVES_WAY = "leans more than at the start", |_, s| s.context.lean.gives_way();
    ARMS_FREE = "arms free long enough", |state, _| releasing(state, |r| r.free >= FREE_TIME);
    FALLS = "arms opening and nothing carries", |state, s| releasing(state, |r| r.opening && s.context.lean.falls());
    HELD_BY_GEARS = "gears alone hold", |state, _| releasing(state, |r| r.kept && !r.opening);
    CALLED_BACK = "perch switch on again, or radio lost", |_, s| Releasing::called_back(s);
    NOT_RELEASED = "arms not free", |state, s| releasing(state, |r| !r.released(s));
    GROUNDED_ON_PIPE = "data-ready line silent before the arms open", |state, s| releasing(state, |r| r.grounded(s));
    LIFTS_OFF = "leans where friction does not hold, and rotors are up", |state, s| releasing(state, |r| r.lifts_off(s));
    LEANS_TOO_FAR = "leans too far before the arms open", |state, s| releasing(state, |r| r.leans(s));

    STUCK = "arms not free in time, and pulling", |state, s| matches!(state, State::Escaping(e) if e.stuck(s.context));
    CLEAR = "clear of the pipe", |state, s| matches!(state, State::Escaping(e) if e.clear(s.context));
    TAKES_OVER = "throttle carries", |_, s| takes_over(s);
    NOT_TAKEN_OVER = "throttle not moved in time", |_, s| s.context.since >= TAKE_OVER_TIME;

    LOST_RADIO = "acting for the radio", |state, _| acts_for(state, Reason::RADIO_LOST);
    THROTTLE_NOT_TAKEN = "acting for the throttle", |state, _| acts_for(state, Reason::NotTakenOver);
    RESUMES = "radio back at once, or roll or pitch stick moved", |_, s| sticks(s, |t| {
        t.roll.abs() > RESUME_STICK || t.pitch.abs() > RESUME_STICK || s.context.since <= RESUME_TIME
    });
}

/// Grip of a vehicle at rest after this step's perch switch.
fn at_rest(state: &State, step: &Step<'_>) -> GripMemory {
    let before = state.behaviour().grip_memory();
    step.context.after_switch(step.inputs.sticks, before)
}

fn sticks(step: &Step<'_>, test: impl Fn(&Sticks) -> bool) -> bool {
    step.inputs.sticks.as_ref().is_some_and(test)
}

fn closing(state: &State, test: impl Fn(&Clamping) -> bool) -> bool {
    matches!(state, State::Clamping(c) if test(c))
}

fn releasing(state: &State, test: impl Fn(&Releasing) -> bool) -> bool {
    matches!(state, State::Releasing(r) if test(r))
}

fn approaching(state: &State, test: impl Fn(&Approach) -> bool) -> bool {
    matches!(state, State::Approach(a) if test(a))
}

fn acts_for(state: &State, cause: Reason) -> bool {
    matches!(state, State::Failsafe(f) if f.cause == cause)
}
