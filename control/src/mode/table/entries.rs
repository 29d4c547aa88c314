//! Entry functions: each builds a state from the previous one.

use crate::gripper::retained_grip::GripMemory;
use crate::maths::scalar;
use crate::mode::context::Step;
use crate::mode::inputs::auto_perch::AutoPerch;
use crate::mode::reason::Reason;
use crate::mode::shared::landing_point::LandingPoint;
use crate::mode::shared::on_pipe::{PipeAttitudeHold, Spool, pressed};
use crate::mode::state::State;
use crate::mode::states::approach::Approach;
use crate::mode::states::armed::Armed;
use crate::mode::states::clamping::Clamping;
use crate::mode::states::contact::Contact;
use crate::mode::states::disarmed::Disarmed;
use crate::mode::states::escaping::Escaping;
use crate::mode::states::failsafe::Failsafe;
use crate::mode::states::flight::Flight;
use crate::mode::states::hold;
use crate::mode::states::landed::Landed;
use crate::mode::states::perched::Perched;
use crate::mode::states::releasing::Releasing;
use crate::pilot::rc::ArmChoice;
use crate::pilot::release_throttle::release_thrust;

/// Calibration has ended; the grip stays unchanged.
pub fn calibrated(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Disarmed {
    let grip_memory = from.behaviour().grip_memory();
    Disarmed {
        grip_memory: step.context.after_switch(step.inputs.sticks, grip_memory),
        actuator_test: None,
    }
}

/// Rotors off; arms that were closed stay closed, and opening them takes a new and deliberate turn of the switch.
pub fn stopped(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Disarmed {
    let free = step.arms_free();
    let grip_memory = match from {
        State::Releasing(r) if r.opening && free => GripMemory::Open,
        State::Escaping(_) if free => GripMemory::Open,
        State::Escaping(_) | State::Clamping(_) | State::Releasing(_) | State::Perched(_) => {
            step.context.perch_switch.seen_on = false;
            from.behaviour().grip_memory()
        }
        _ => from.behaviour().grip_memory(),
    };
    Disarmed {
        grip_memory,
        actuator_test: None,
    }
}

/// Rotors idle.
pub fn armed(_: &State, _: &mut Step<'_>, _: Option<Reason>) -> Armed {
    Armed
}

/// The pilot flies.
pub fn flight(_: &State, _: &mut Step<'_>, _: Option<Reason>) -> Flight {
    Flight
}

/// Holds the present position; a later hold takes a new turn of the switch.
pub fn holding(_: &State, step: &mut Step<'_>, _: Option<Reason>) -> hold::Hold {
    step.context.hold_seen_off = false;
    hold::Hold::here(step)
}

/// Hold after autonomous flight: perching again takes a new turn of its switch.
pub fn handed_back(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> hold::Hold {
    step.context.hold_seen_off = false;
    step.context.perch_switch.seen_off = false;
    let position_hold = match from {
        State::Approach(a) => Some(a.position_hold),
        _ => None,
    };
    hold::Hold::after(position_hold, step)
}

/// The search for the pipe begins.
pub fn approach(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Approach {
    step.context.perch_switch.seen_off = false;
    let nose = present_heading(step);
    // Heading of the pipe if known; otherwise the pipe lies along the nose.
    let turn = step.inputs.position.map_or(0.0, |e| e.yaw_offset);
    let pipe = step
        .inputs
        .target
        .and_then(|target| target.heading_near(nose + turn));
    let heading = pipe.map_or(nose, |pipe| scalar::wrap_pi(pipe - turn));
    step.context.auto_perch.begin(heading);
    let position_hold = match from {
        State::Hold(h) => Some(h.place.position_hold),
        _ => None,
    };
    Approach::search(position_hold, step)
}

/// Clear of the pipe: climbs, then starts another try, except after a release.
pub fn approach_again(_: &State, step: &mut Step<'_>, _: Option<Reason>) -> Approach {
    let auto_perch = &mut step.context.auto_perch;
    auto_perch.tries = auto_perch.tries.saturating_add(1);
    let leaves = auto_perch.leaving;
    Approach::climb(step, leaves)
}

/// On the ground.
pub fn landed(_: &State, _: &mut Step<'_>, _: Option<Reason>) -> Landed {
    Landed
}

/// On the pipe, with the pilot's choice of arms.
pub fn contact(_: &State, step: &mut Step<'_>, _: Option<Reason>) -> Contact {
    let arms = step.inputs.sticks.unwrap_or_default().arms;
    Contact {
        hold: present(step, arms),
    }
}

/// The arms begin to close. If the radio has just been lost, the vehicle finishes the landing that the pilot began.
pub fn closing(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Clamping {
    step.context.lean.capture_lean();
    step.context.tightened = 0;
    step.context.perch_switch.seen_on = step.inputs.sticks.is_some();
    Clamping {
        hold: hold(from),
        spool: Spool::at(1.0),
    }
}

/// The arms stay closed, or close again. If the radio is lost, they hold; a later release takes a new turn of the
/// switch.
pub fn closing_again(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Clamping {
    step.context.lean.capture_lean();
    step.context.perch_switch.seen_on = Releasing::called_back(step) && step.inputs.sticks.is_some();
    let share = match from {
        State::Releasing(r) => r.spooled(step.dt),
        _ => 0.0,
    };
    Clamping {
        hold: hold(from),
        spool: Spool::at(share),
    }
}

/// The arms hold and the rotors have stopped.
pub fn perched(from: &State, _: &mut Step<'_>, _: Option<Reason>) -> Perched {
    Perched::on(from.behaviour().grip_memory())
}

/// Stops the rotors on the grip because of a danger: opening takes a new turn of the switch.
pub fn stopped_on_grip(from: &State, step: &mut Step<'_>, why: Option<Reason>) -> Perched {
    step.context.perch_switch.seen_on = false;
    perched(from, step, why)
}

/// Armed deliberately at this switch position: from then on, turning the switch off releases.
pub fn armed_on_pipe(from: &State, step: &mut Step<'_>, why: Option<Reason>) -> Perched {
    let perch = &mut step.context.perch_switch;
    perch.seen_on = step.inputs.sticks.is_some_and(|s| s.perch_switch);
    perch.left_on = false;
    perched(from, step, why)
}

/// The pilot releases: the rotors spool up first.
pub fn releasing(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Releasing {
    step.context.auto_perch = AutoPerch::default();
    step.context.lean.capture_lean();
    let grip_memory = from.behaviour().grip_memory();
    Releasing {
        hold: present(step, grip_memory.arms().unwrap_or_default()),
        share: 0.0,
        free: 0.0,
        opening: false,
        kept: matches!(grip_memory, GripMemory::HeldByGears(_)),
    }
}

/// Leaves after a slip: a slow spool-up would lift the belly off the pipe while the arms still close, and the slide
/// would continue.
pub fn leaving(from: &State, step: &mut Step<'_>, why: Option<Reason>) -> Escaping {
    step.context.auto_perch = AutoPerch::default();
    step.context.lean.capture_lean();
    giving_up(from, step, why)
}

/// Ends the closing when the arms carry the weight and the rotors may have stopped: these spool up first, as on a
/// release.
pub fn releasing_instead(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Releasing {
    step.context.perch_switch.seen_off = false;
    let share = match from {
        State::Clamping(c) => c.spool.share,
        _ => 0.0,
    };
    Releasing {
        hold: hold(from),
        share,
        free: 0.0,
        opening: false,
        kept: false,
    }
}

/// Autonomous release, with the throttle centred.
pub fn releasing_autonomously(from: &State, step: &mut Step<'_>, why: Option<Reason>) -> Releasing {
    let releasing = releasing(from, step, why);
    let heading = present_heading(step);
    step.context.auto_perch.leave(heading);
    releasing
}

/// Leaves the pipe autonomously, with free arms.
pub fn lifting_off(_: &State, step: &mut Step<'_>, _: Option<Reason>) -> Escaping {
    Escaping::leaving(step.inputs, GripMemory::Open, None)
}

/// Arms do not come free while the rotors pull at them: reduces the throttle and keeps the tendons slack.
pub fn releasing_stuck(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Releasing {
    let arms = from.behaviour().grip_memory().arms().unwrap_or_default();
    Releasing {
        hold: present(step, arms),
        share: 1.0,
        free: 0.0,
        opening: true,
        kept: false,
    }
}

/// Leaves the pipe from which the vehicle slides or falls.
pub fn sliding(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Escaping {
    let grip_memory = match from {
        State::Clamping(Clamping { hold, .. }) | State::Releasing(Releasing { hold, .. }) => {
            GripMemory::Controlled(hold.arms)
        }
        _ => GripMemory::Open,
    };
    step.context.perch_switch.seen_off = false;
    Escaping::leaving(step.inputs, grip_memory, None)
}

/// Leaves the pipe on which the vehicle stands.
pub fn giving_up(from: &State, step: &mut Step<'_>, _: Option<Reason>) -> Escaping {
    step.context.perch_switch.seen_off = false;
    let from_thrust = step.context.collective.now();
    let least = release_thrust(&step.context.params);
    let grip_memory = from.behaviour().grip_memory();
    let pressed = grip_memory
        .arms()
        .is_some_and(|arms| pressed(step.inputs.grip, arms));
    Escaping::leaving(
        step.inputs,
        grip_memory,
        pressed.then_some(from_thrust.max(least)),
    )
}

/// The failsafe acts for the reason of the transition.
pub fn failsafe(from: &State, step: &mut Step<'_>, why: Option<Reason>) -> Failsafe {
    Failsafe::begin(why.unwrap_or(Reason::RADIO_LOST), step, |step| match from {
        State::Failsafe(before) => before.landing_point,
        State::Hold(hold) => Some(LandingPoint::held(hold.place, step)),
        State::Approach(approach) => {
            let position = step.inputs.position;
            let off_pipe = position.and_then(|e| approach.off_pipe(e.position));
            Some(LandingPoint::off_approach(approach.position_hold, off_pipe, step))
        }
        State::Releasing(_) | State::Escaping(_) => LandingPoint::beside_pipe(step),
        _ => LandingPoint::here(step),
    })
}

fn present_heading(step: &Step<'_>) -> f32 {
    step.inputs.motion.map_or(0.0, |m| m.q.to_euler().2)
}

/// The present attitude, held with `arms`.
fn present(step: &Step<'_>, arms: ArmChoice) -> PipeAttitudeHold {
    let (roll, pitch, _) = step.inputs.motion.map_or((0.0, 0.0, 0.0), |m| m.q.to_euler());
    PipeAttitudeHold { roll, pitch, arms }
}

/// Attitude and arms that `from` holds on the pipe.
fn hold(from: &State) -> PipeAttitudeHold {
    match from {
        State::Contact(Contact { hold })
        | State::Clamping(Clamping { hold, .. })
        | State::Releasing(Releasing { hold, .. }) => *hold,
        _ => PipeAttitudeHold::default(),
    }
}
