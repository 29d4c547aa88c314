//! Autonomous free flight onto the pipe, or off it.

use crate::approach::limits::{CLIMB_SPEED, LOST_TIME, RANGE_AGE};
use crate::approach::planner::{ApproachAbort, ApproachPlanner, View};
use crate::arming::ArmingInhibits;
use crate::chain::setpoint::Setpoint;
use crate::contact::contact_force::HINT_FORCE;
use crate::maths::scalar::clamp;
use crate::maths::vector::Vec3;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::inputs::Inputs;
use crate::mode::inputs::auto_perch::{LastCrown, TRIES};
use crate::mode::reason::Reason;
use crate::navigation::estimate::Estimate;
use crate::pilot::stick_positions::{centred, keeps_hold};
use crate::position_hold::{PositionHold, VelocityCommand};

/// Time for which the place of the pipe may be missing, s, as long as a position may at first: a camera loses a tag, and a pipe
/// stays where it is.
const TARGET_WAIT: f32 = 3.0;

/// State of the mode [`crate::mode::Mode::Approach`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    pub position_hold: PositionHold,
    planner: ApproachPlanner,
    wanted: Setpoint,
    /// Reason for which no further try follows.
    pub abort_reason: Option<Reason>,
    /// Reason that becomes `abort_reason` once the vehicle has climbed.
    pending_abort_reason: Option<Reason>,
    /// The try ended by a contact.
    aborted_in_contact: bool,
    /// It waits for the position; time for which it has waited for the place of the pipe, s.
    adrift: bool,
    waits: f32,
}

/// The perch switch was turned on while the position is held.
pub fn asked(step: &Step<'_>) -> bool {
    let turned = step.context.perch_switch.seen_off;
    let wanted = |s: crate::pilot::rc::Sticks| s.perch_switch && keeps_hold(&s);
    turned && step.inputs.sticks.is_some_and(wanted)
}

/// Reason for which the approach cannot begin.
pub fn obstacle(step: &Step<'_>) -> Option<Reason> {
    let sticks = step.inputs.sticks.unwrap_or_default();
    let ranged = |e: Estimate| e.range_hit.age <= RANGE_AGE;
    if let Some(why) = step.inputs.servo_trouble() {
        Some(Reason::Check(why))
    } else if !centred(&sticks) {
        Some(Reason::SticksNotCentred)
    } else if !step.inputs.position_fresh() {
        Some(Reason::NoPosition)
    } else if !step.context.thrust.is_known() {
        Some(Reason::ThrustUnknown)
    } else if let (Some(target), Some(e)) = (step.inputs.target, step.inputs.position) {
        (!ApproachPlanner::reaches(&target, &e)).then_some(Reason::TargetFar)
    } else if !step.inputs.position.is_some_and(ranged) {
        Some(Reason::NoRange)
    } else {
        None
    }
}

impl Approach {
    /// Starts the search at the point that `position_hold` holds.
    pub fn search(position_hold: Option<PositionHold>, step: &mut Step<'_>) -> Self {
        Self::begin(position_hold, step, |step, view, e| {
            ApproachPlanner::begin(&step.context.params, view, heading(step, e), e.reset_count)
        })
    }

    /// Climbs off the pipe: `left` ends there, otherwise a new search follows.
    pub fn climb(step: &mut Step<'_>, left: bool) -> Self {
        let crown = step.context.auto_perch.last_crown.filter(|_| !left);
        Self::begin(None, step, |step, view, e| {
            let (params, heading) = (&step.context.params, heading(step, e));
            match crown {
                Some(crown) if crown.reset_count == e.reset_count => {
                    ApproachPlanner::back_to(crown.position, params, view, heading, e.reset_count)
                }
                _ => ApproachPlanner::again(params, view, heading, e.reset_count, left),
            }
        })
    }

    fn begin(
        position_hold: Option<PositionHold>,
        step: &mut Step<'_>,
        planner: impl Fn(&Step<'_>, &View, &Estimate) -> ApproachPlanner,
    ) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let position_hold = position_hold.unwrap_or_else(|| step.position_hold(&estimate));
        let planner = planner(step, &view(&position_hold, &estimate, step), &estimate);
        let mut approach = Self {
            position_hold,
            planner,
            wanted: Setpoint::Stop,
            abort_reason: None,
            pending_abort_reason: None,
            aborted_in_contact: false,
            adrift: false,
            waits: 0.0,
        };
        approach.step(&estimate, step);
        approach
    }

    /// The vehicle descends onto the pipe.
    pub fn committed(&self) -> bool {
        self.planner.committed()
    }

    /// The vehicle crosses the pipe at a height where contact is unexpected.
    pub fn not_committed(&self) -> bool {
        !self.committed() && !self.planner.climbs()
    }

    /// The try has ended while something seemed to carry the vehicle.
    pub fn aborted_in_contact(&self) -> bool {
        self.aborted_in_contact
    }

    /// The vehicle has climbed off the pipe.
    pub fn has_left(&self) -> bool {
        self.planner.has_left()
    }

    /// Horizontal unit vector off the pipe for a vehicle at `position`, in the estimate's axes; `None` if unknown.
    pub fn off_pipe(&self, position: Vec3) -> Option<Vec3> {
        self.planner.off_pipe(position)
    }

    fn step(&mut self, estimate: &Estimate, step: &mut Step<'_>) {
        // The flow goes on, but no range fits the height; a source that is silent as a whole has limits of its own.
        let height_lost =
            estimate.height_age > LOST_TIME && step.inputs.position_fresh() && !estimate.by_pressure;
        let adrift = step.inputs.position_adrift() || height_lost;
        let blind = self.planner.asks_target() && step.inputs.target.is_none();
        self.adrift |= adrift;
        self.waits = if blind && !adrift {
            clamp(self.waits + step.dt, 0.0, TARGET_WAIT)
        } else {
            0.0
        };
        if adrift || (blind && self.waits < TARGET_WAIT) {
            self.wait(estimate, (!adrift, !step.inputs.position_adrift()), step);
            return;
        }
        if core::mem::take(&mut self.adrift) {
            self.position_hold.anchor_at(estimate);
            let seen = view(&self.position_hold, estimate, step);
            self.again(Reason::PositionStale, &seen, estimate, step);
        }
        let seen = view(&self.position_hold, estimate, step);
        let result = if self.planner.jumped(estimate.reset_count) {
            Err(ApproachAbort::NotCentred)
        } else {
            self.planner.step(&seen, step.dt)
        };
        if self.planner.has_left() {
            self.abort_reason = self.pending_abort_reason;
        }
        let crown = self.planner.crown_position().map(|position| LastCrown {
            position,
            reset_count: estimate.reset_count,
        });
        step.context.auto_perch.last_crown = crown.or(step.context.auto_perch.last_crown);
        let command = result.unwrap_or_else(|doubt| {
            match doubt {
                ApproachAbort::RangeMisfit => self.misfit(&seen, estimate, step),
                _ => self.again(reason(doubt), &seen, estimate, step),
            }
            VelocityCommand::default()
        });
        self.wanted = self
            .position_hold
            .step(estimate, &step.body_motion(), &command, true, step.dt);
    }

    /// Waits for the place of the pipe where it is `known` where the vehicle is. Otherwise it rises, so that who takes over has room
    /// below, over a place that is `held` or level against the learnt wind.
    fn wait(&mut self, estimate: &Estimate, (known, held): (bool, bool), step: &mut Step<'_>) {
        let (why, rise) = if known {
            (Reason::TargetStale, 0.0)
        } else {
            (Reason::PositionStale, CLIMB_SPEED)
        };
        step.context.note(Some(why));
        let rise = VelocityCommand {
            velocity: Vec3::new(0.0, 0.0, -rise),
            ..VelocityCommand::default()
        };
        self.wanted = self
            .position_hold
            .step(estimate, &step.body_motion(), &rise, held, step.dt);
    }

    /// Allows one more try; then climbs away.
    fn misfit(&mut self, view: &View, e: &Estimate, step: &mut Step<'_>) {
        let before = core::mem::replace(&mut step.context.auto_perch.misfit, true);
        let cleared = self
            .planner
            .cleared(&step.context.params, view, heading(step, e), e.reset_count);
        self.again(Reason::RangeMisfit, view, e, step);
        if before && !self.aborted_in_contact {
            (self.abort_reason, self.pending_abort_reason) = (None, Some(Reason::RangeMisfit));
            self.planner = cleared;
        }
    }

    /// Starts another try, or ends with the reason `why`.
    fn again(&mut self, why: Reason, view: &View, e: &Estimate, step: &mut Step<'_>) {
        step.context.note(Some(why));
        if self.committed() && step.context.contact_force.force() > HINT_FORCE {
            (self.aborted_in_contact, self.abort_reason) = (true, Some(why));
            return;
        }
        let tries = &mut step.context.auto_perch.tries;
        let searched = matches!(
            why,
            Reason::NoPipe | Reason::RangeStale | Reason::TargetStale | Reason::TargetFar
        );
        if *tries >= TRIES || searched {
            self.abort_reason = Some(why);
        } else {
            *tries += 1;
            let heading = heading(step, e);
            self.planner = self
                .planner
                .retried(&step.context.params, view, heading, e.reset_count);
        }
    }
}

fn view(position_hold: &PositionHold, e: &Estimate, step: &Step<'_>) -> View {
    let heading = step.inputs.motion.map_or(0.0, |m| m.q.to_euler().2);
    View {
        position: e.position,
        velocity: e.velocity,
        heading: heading + e.yaw_offset,
        held: position_hold.held(),
        age: e.age,
        range_hit: e.range_hit,
        levels: e.levels,
        target: step.inputs.target,
    }
}

/// Heading along the pipe in the estimate's axes, rad.
fn heading(step: &Step<'_>, e: &Estimate) -> f32 {
    step.context.auto_perch.heading + e.yaw_offset
}

fn reason(doubt: ApproachAbort) -> Reason {
    match doubt {
        ApproachAbort::NoPipe => Reason::NoPipe,
        ApproachAbort::TooShort => Reason::PipeTooShort,
        ApproachAbort::PipeLost => Reason::PipeLost,
        ApproachAbort::NotCentred => Reason::NotCentred,
        ApproachAbort::NotTouched => Reason::NotTouched,
        ApproachAbort::RangeStale => Reason::RangeStale,
        ApproachAbort::RangeMisfit => Reason::RangeMisfit,
        ApproachAbort::TargetStale => Reason::TargetStale,
        ApproachAbort::TargetFar => Reason::TargetFar,
        ApproachAbort::TargetJumps => Reason::TargetJumps,
    }
}

impl Behaviour for Approach {
    fn advance(&mut self, step: &mut Step<'_>) {
        // A silent inertial sensor stops the rotors within some steps; until then the last setpoint stands.
        if let (Some(estimate), Some(_)) = (step.inputs.position, step.inputs.motion) {
            step.calm(&mut self.position_hold);
            self.step(&estimate, step);
        }
    }

    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        self.wanted
    }

    fn reason(&self, context: &Context, inputs: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        context.reason(inputs, true)
    }
}
