//! Every transition, the first that applies first: the order of the rows is their priority.

use super::entries;
use super::guards::*;
use crate::mode::context::Step;
use crate::mode::modes::Mode;
use crate::mode::reason::Reason;
use crate::mode::state::{Entry, State};

/// Reason that a transition displays to the pilot.
#[derive(Clone, Copy, Debug)]
pub enum Notice {
    /// Keeps the displayed reason.
    Keep,
    /// Clears it.
    Clear,
    /// Displays this reason for some seconds.
    Show(Reason),
    /// Displays the reason that the function returns for some seconds: the cause that ended a state.
    ShowOf(fn(&State, &Step<'_>) -> Option<Reason>),
    /// The new state displays this reason for as long as it lasts.
    Lasting(Reason),
    /// The new state displays the reason that the function returns for as long as it lasts.
    LastingOf(fn(&Step<'_>) -> Option<Reason>),
}

/// The modes in which a row applies.
#[derive(Clone, Copy, Debug)]
pub enum Origin {
    /// These.
    In(&'static [Mode]),
    /// Every mode in which rotors may turn: a row that stops a flight also applies to a new mode.
    RotorsTurning,
}

impl Origin {
    fn contains(self, mode: Mode) -> bool {
        match self {
            Self::In(modes) => modes.contains(&mode),
            Self::RotorsTurning => !mode.rotors_stand(),
        }
    }
}

/// One row.
#[derive(Clone, Copy, Debug)]
pub struct Transition {
    /// The modes in which it applies.
    pub from: Origin,
    /// Guards, all of which must hold.
    pub when: &'static [Guard],
    /// The state that begins.
    pub to: Entry,
    /// Displayed reason.
    pub notice: Notice,
}

const fn row(from: &'static [Mode], when: &'static [Guard], to: Entry, notice: Notice) -> Transition {
    Transition {
        from: Origin::In(from),
        when,
        to,
        notice,
    }
}

const fn rotors(when: &'static [Guard], to: Entry, notice: Notice) -> Transition {
    Transition {
        from: Origin::RotorsTurning,
        when,
        to,
        notice,
    }
}

use Entry as To;
use Mode::{
    Approach, Armed, Calibrating, Clamping, Contact, Disarmed, Escaping, Failsafe, Flight, Hold, Landed,
    Perched, Releasing,
};
use Notice::{Clear, Keep, Lasting, LastingOf, Show, ShowOf};

/// The modes in which an arm may hold while rotors turn.
const CLOSED: &[Mode] = &[Clamping, Releasing];
const IDLE: &[Mode] = &[Armed, Landed];
/// The modes in which the pilot flies, all in free air.
const FLOWN: &[Mode] = &[Flight, Hold];
const AIRBORNE: &[Mode] = &[Flight, Hold, Approach];

/// Reason that ends a closing.
const DOUBTED: Notice = ShowOf(|state, step| match state {
    State::Clamping(c) => c.doubt(step),
    _ => None,
});
/// Reason that ends autonomous perching.
const HANDED_BACK: Notice = ShowOf(|state, _| match state {
    State::Approach(a) => a.abort_reason,
    _ => None,
});
/// Cause of the failsafe.
const CAUSE: Notice = ShowOf(|state, _| match state {
    State::Failsafe(f) => Some(f.cause),
    _ => None,
});

/// Reason of a forced landing.
const LANDS: Notice = LastingOf(|step| step.context.dangers.landing());

/// Every transition in the order of priority.
#[rustfmt::skip]
pub const TRANSITIONS: &[Transition] = &[
    // Everything is dropped.
    row(CLOSED, &[ARM_SWITCH_OFF, ARMS_STAY], To::Perched(entries::stopped_on_grip), Clear),
    rotors(&[ARM_SWITCH_OFF], To::Disarmed(entries::stopped), Clear),
    row(CLOSED, &[IMU_SILENT, ARMS_STAY], To::Perched(entries::stopped_on_grip), Show(Reason::IMU_SILENT)),
    rotors(&[IMU_SILENT], To::Disarmed(entries::stopped), Show(Reason::IMU_SILENT)),
    row(CLOSED, &[TIPPED_OVER, ARMS_STAY], To::Perched(entries::stopped_on_grip), Show(Reason::TippedOver)),
    rotors(&[TIPPED_OVER], To::Disarmed(entries::stopped), Show(Reason::TippedOver)),
    // On the ground.
    row(&[Calibrating], &[CALIBRATED], To::Disarmed(entries::calibrated), Keep),
    row(&[Disarmed], &[ARM_GESTURE, CHECKS_PASS, ARMS_CLOSED], To::Perched(entries::armed_on_pipe), Keep),
    row(&[Disarmed], &[ARM_GESTURE, CHECKS_PASS], To::Armed(entries::armed), Clear),
    row(IDLE, &[RADIO_LOST], To::Disarmed(entries::stopped), Show(Reason::RADIO_LOST)),
    row(IDLE, &[LINE_SILENT], To::Disarmed(entries::stopped), Show(Reason::LINE_SILENT)),
    row(IDLE, &[DISARM_GESTURE], To::Disarmed(entries::stopped), Clear),
    row(IDLE, &[THROTTLE_UP], To::Flight(entries::flight), Keep),
    row(&[Armed], &[IDLED], To::Disarmed(entries::stopped), Show(Reason::IdleTooLong)),
    row(&[Landed], &[STOOD], To::Disarmed(entries::stopped), Clear),
    // In the air.
    row(AIRBORNE, &[RADIO_LOST], To::Failsafe(entries::failsafe), Lasting(Reason::RADIO_LOST)),
    row(AIRBORNE, &[MUST_LAND], To::Failsafe(entries::failsafe), LANDS),
    // The pilot's sticks and switches first.
    row(&[Hold, Approach], &[HOLD_OFF], To::Flight(entries::flight), Clear),
    // In contact, a hold would slide off the pipe: climbs away as from a perch.
    row(&[Approach], &[FEELS_PIPE, TAKEN_OVER], To::Escaping(entries::sliding), Show(Reason::TakenOver)),
    row(&[Approach], &[FEELS_PIPE, POSITION_ADRIFT], To::Escaping(entries::sliding), Show(Reason::PositionStale)),
    row(&[Approach], &[ABORTED_IN_CONTACT], To::Escaping(entries::sliding), HANDED_BACK),
    row(&[Approach], &[NOT_COMMITTED, TOUCHED], To::Escaping(entries::sliding), Show(Reason::TouchedEarly)),
    row(&[Approach], &[TAKEN_OVER], To::Hold(entries::handed_back), Show(Reason::TakenOver)),
    row(&[Approach], &[POSITION_AWAITED], To::Hold(entries::handed_back), Show(Reason::PositionStale)),
    row(&[Approach], &[HAS_SWUNG, SWINGS], To::Hold(entries::handed_back), Show(Reason::Swings)),
    row(&[Approach], &[APPROACH_ABORTED], To::Hold(entries::handed_back), HANDED_BACK),
    row(&[Approach], &[DEPARTED], To::Hold(entries::handed_back), Clear),
    row(FLOWN, &[THROTTLE_LOW, GROUNDED], To::Landed(entries::landed), Keep),
    row(&[Hold], &[HAS_SWUNG, SWINGS], To::Flight(entries::flight), Show(Reason::Swings)),
    row(&[Hold], &[POSITION_LOST], To::Flight(entries::flight), Show(Reason::PositionLost)),
    row(&[Flight], &[SETS_DOWN, SWITCH_TURNED, SLIDES_AT_TOUCH],
        To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Flight], &[SETS_DOWN, SWITCH_TURNED, FALLS_BESIDE], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Flight], &[MEANS_TO_PERCH, SWITCH_TURNED, SERVOS_FED, TOUCHED, LEVEL], To::Contact(entries::contact), Keep),
    row(&[Flight], &[HOLD_ON, HOLD_TURNED, MOTORS_FOLLOW, POSITION_FRESH, NOT_RESTING], To::Hold(entries::holding), Clear),
    row(&[Hold], &[ASKED_TO_PERCH, MAY_APPROACH], To::Approach(entries::approach), Clear),
    row(&[Approach], &[COMMITTED, SLIDES_AT_TOUCH], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Approach], &[COMMITTED, TOUCHED, LEVEL], To::Contact(entries::contact), Keep),
    // Onto the pipe.
    row(&[Contact], &[AUTO_PERCH, TAKEN_OVER], To::Escaping(entries::giving_up), Show(Reason::TakenOver)),
    row(&[Contact], &[BY_HAND, CALLED_OFF], To::Flight(entries::flight), Keep),
    row(&[Contact], &[SLIDES], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Contact], &[TWISTS], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Contact], &[LIFTED], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Contact], &[RESTED], To::Clamping(entries::closing), Keep),
    // Half-closed arms slide round the pipe with the body, pressed.
    row(&[Clamping], &[UNPROVEN, SLIDES], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Clamping], &[LOOSE, SLIDES], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Clamping], &[LOOSE, CREEPS], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Clamping], &[UNPROVEN, LOOSE, TWISTS], To::Escaping(entries::giving_up), Show(Reason::SlidesOff)),
    row(&[Clamping], &[DOUBT, MAY_LEAVE, SPOOLED_ON_GRIP], To::Releasing(entries::releasing_instead), DOUBTED),
    row(&[Clamping], &[DOUBT, MAY_LEAVE], To::Escaping(entries::giving_up), DOUBTED),
    row(&[Clamping], &[STANDS, GRIP_PROVEN], To::Perched(entries::perched), Keep),
    row(&[Clamping], &[STANDS, LAST_RESORT], To::Disarmed(entries::stopped), Keep),
    // Off the pipe.
    row(&[Perched], &[ARM_SWITCH_OFF, DISARM_GESTURE], To::Disarmed(entries::stopped), Keep),
    row(&[Perched], &[AUTO_RELEASE, MAY_FLY, UPRIGHT], To::Releasing(entries::releasing_autonomously), Keep),
    row(&[Perched], &[RELEASE_ASKED, SLIPPED, MAY_FLY, UPRIGHT], To::Escaping(entries::leaving), Show(Reason::LiftsOff)),
    row(&[Perched], &[RELEASE_ASKED, MAY_FLY, UPRIGHT], To::Releasing(entries::releasing), Keep),
    row(&[Releasing], &[ARMS_FREE, RADIO_LOST], To::Failsafe(entries::failsafe), Lasting(Reason::RADIO_LOST)),
    row(&[Releasing], &[ARMS_FREE, AUTO_PERCH], To::Escaping(entries::lifting_off), Keep),
    row(&[Releasing], &[ARMS_FREE], To::Flight(entries::flight), Keep),
    row(&[Releasing], &[LOOSE, SLIDES], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Releasing], &[GIVES_WAY], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Releasing], &[FALLS], To::Escaping(entries::sliding), Show(Reason::SlidesOff)),
    row(&[Releasing], &[HELD_BY_GEARS, CALLED_BACK], To::Perched(entries::perched), Keep),
    row(&[Releasing], &[HELD_BY_GEARS, GROUNDED_ON_PIPE], To::Perched(entries::perched), Keep),
    row(&[Releasing], &[LEANS_TOO_FAR], To::Clamping(entries::closing_again), Show(Reason::LeansTooFar)),
    row(&[Releasing], &[LIFTS_OFF], To::Escaping(entries::giving_up), Show(Reason::LiftsOff)),
    row(&[Releasing], &[CALLED_BACK, NOT_RELEASED], To::Clamping(entries::closing_again), Keep),
    row(&[Releasing], &[GROUNDED_ON_PIPE], To::Clamping(entries::closing_again), Keep),
    row(&[Escaping], &[STUCK], To::Releasing(entries::releasing_stuck), Show(Reason::ArmsStuck)),
    row(&[Escaping], &[CLEAR, RADIO_LOST], To::Failsafe(entries::failsafe), Lasting(Reason::RADIO_LOST)),
    row(&[Escaping], &[CLEAR, MUST_LAND], To::Failsafe(entries::failsafe), LANDS),
    row(&[Escaping], &[CLEAR, DEPARTING, POSITION_FRESH], To::Approach(entries::approach_again), Keep),
    row(&[Escaping], &[CLEAR, TRY_LEFT, SERVOS_FED, POSITION_FRESH], To::Approach(entries::approach_again), Keep),
    row(&[Escaping], &[CLEAR, AUTO_PERCH, HOLD_KEPT, POSITION_FRESH], To::Hold(entries::handed_back), Keep),
    row(&[Escaping], &[CLEAR, BY_HAND, TAKES_OVER], To::Flight(entries::flight), Keep),
    row(&[Escaping], &[CLEAR, NOT_TAKEN_OVER], To::Failsafe(entries::failsafe), Lasting(Reason::NotTakenOver)),
    // Support alone proves nothing: a vehicle lighter or stronger than its parameters would seem carried in free air. On
    // real ground the probe reduces thrust until the ground carries most of the weight.
    row(&[Failsafe], &[GROUNDED], To::Disarmed(entries::stopped), CAUSE),
    row(&[Failsafe], &[LOST_RADIO, RADIO, MUST_LAND], To::Failsafe(entries::failsafe), LANDS),
    row(&[Failsafe], &[THROTTLE_NOT_TAKEN, RADIO, MUST_LAND], To::Failsafe(entries::failsafe), LANDS),
    row(&[Failsafe], &[THROTTLE_NOT_TAKEN, TAKES_OVER], To::Flight(entries::flight), Keep),
    row(&[Failsafe], &[THROTTLE_NOT_TAKEN, RADIO_LOST], To::Failsafe(entries::failsafe), Lasting(Reason::RADIO_LOST)),
    row(&[Failsafe], &[LOST_RADIO, RESUMES], To::Flight(entries::flight), Keep),
];

impl Transition {
    /// The first row that applies to `state` in this step.
    pub fn first(state: &State, step: &Step<'_>) -> Option<&'static Self> {
        let mode = state.mode();
        TRANSITIONS
            .iter()
            .find(|row| row.from.contains(mode) && row.when.iter().all(|guard| (guard.holds)(state, step)))
    }

    /// Builds the state that begins, and notes its displayed reason.
    pub fn enter(&self, from: &State, step: &mut Step<'_>) -> State {
        let why = match self.notice {
            Keep | Clear => None,
            Show(why) | Lasting(why) => Some(why),
            ShowOf(why) => why(from, step),
            LastingOf(why) => why(step),
        };
        if !matches!(self.notice, Keep | Lasting(_) | LastingOf(_)) {
            step.context.note(why);
        }
        self.to.enter(from, step, why)
    }
}
