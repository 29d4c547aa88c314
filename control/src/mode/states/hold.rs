//! Free flight that holds the position.

use super::approach;
use crate::arming::ArmingInhibits;
use crate::maths::scalar::{GRAVITY, clamp, clamp_abs, tan};
use crate::maths::vector::Vec3;
use crate::mode::behaviour::Behaviour;
use crate::mode::context::{Context, Step};
use crate::mode::shared::collective;
use crate::mode::{Inputs, Reason, Setpoint};
use crate::navigation::fix_age::{APPROACH_AGE, COAST_AGE, FRESH_AGE, HEIGHT_AGE, PRESSURE_AGE};
use crate::navigation::position_estimator::Estimate;
use crate::pilot::rc::Sticks;
use crate::pilot::stick_positions::{THROTTLE_CENTRE, THROTTLE_ZONE};
use crate::position_hold::{CLIMB_MAX, Felt, PositionHold, SPEED_MAX, Wish};

/// There is a position to begin with.
pub fn fresh(i: &Inputs) -> bool {
    i.motion.is_some() && younger(i, FRESH_AGE)
}

/// The inertial sensor alone is no longer good for an approach.
pub fn adrift(i: &Inputs) -> bool {
    !younger(i, APPROACH_AGE)
}

/// Nothing is known any more.
pub fn lost(i: &Inputs) -> bool {
    let by_pressure = i.position.is_some_and(|e| e.by_pressure);
    !younger(i, if by_pressure { PRESSURE_AGE } else { HEIGHT_AGE })
}

fn younger(i: &Inputs, age: f32) -> bool {
    i.position.is_some_and(|e| e.age <= age)
}

/// The law with a position that may go and come back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    pub law: PositionHold,
    /// The position is none at present.
    adrift: bool,
}

impl Place {
    pub fn new(law: PositionHold) -> Self {
        Self { law, adrift: false }
    }

    /// One step: up to [`COAST_AGE`] of the estimate it holds, then it keeps level, and holds where the vehicle is once there
    /// is a position again.
    pub fn step(&mut self, estimate: &Estimate, wish: &Wish, step: &Step<'_>) -> Setpoint {
        let adrift = estimate.age > COAST_AGE;
        if self.adrift && !adrift {
            self.law.anchor_at(estimate);
        }
        self.adrift = adrift;
        self.law.step(estimate, &felt(step), wish, !adrift, step.dt)
    }
}

/// See [`crate::mode::Mode::Hold`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    pub place: Place,
    wanted: Setpoint,
    /// The throttle was centred since the hold began: until then, where it stands is no wish.
    centred: bool,
}

impl Hold {
    /// Holds where the vehicle is.
    pub fn here(step: &mut Step<'_>) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let law = PositionHold::begin(&step.context.params, &estimate, &felt(step));
        Self::begin(law, false, step)
    }

    /// Holds where the vehicle is after it has flown by itself, with what `law` has learnt: the sticks were centred.
    pub fn after(law: Option<PositionHold>, step: &mut Step<'_>) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let mut law =
            law.unwrap_or_else(|| PositionHold::begin(&step.context.params, &estimate, &felt(step)));
        law.anchor_at(&estimate);
        Self::begin(law, true, step)
    }

    fn begin(law: PositionHold, centred: bool, step: &mut Step<'_>) -> Self {
        let estimate = step.inputs.position.unwrap_or_default();
        let mut hold = Self {
            place: Place::new(law),
            wanted: Setpoint::Stop,
            centred,
        };
        hold.step(&estimate, step);
        hold
    }

    fn step(&mut self, estimate: &Estimate, step: &Step<'_>) {
        let sticks = step.inputs.sticks.unwrap_or_default();
        self.centred |= (sticks.throttle - THROTTLE_CENTRE).abs() <= THROTTLE_ZONE;
        let climb = if self.centred { climb(sticks.throttle) } else { 0.0 };
        let wish = wished(&sticks, climb, step.context);
        self.wanted = self.place.step(estimate, &wish, step);
    }
}

/// What the sticks ask for, `climb` being a share of the fastest one, -1..1.
pub fn wished(s: &Sticks, climb: f32, context: &Context) -> Wish {
    let lean = |stick: f32| GRAVITY * tan(clamp_abs(stick * context.params.stick_angle, 1.0));
    let yaw_rate = match collective::from_sticks(s, &context.params) {
        Setpoint::Angle { yaw_rate, .. } => yaw_rate,
        _ => 0.0,
    };
    Wish {
        velocity: Vec3::new(-s.pitch * SPEED_MAX, s.roll * SPEED_MAX, -climb * CLIMB_MAX),
        yaw_rate,
        lean: [-lean(s.pitch), lean(s.roll)],
    }
}

/// Share of the fastest climb that a throttle asks for, -1..1.
fn climb(throttle: f32) -> f32 {
    let off = throttle - THROTTLE_CENTRE;
    let beyond = clamp(off.abs() - THROTTLE_ZONE, 0.0, 1.0) / (THROTTLE_CENTRE - THROTTLE_ZONE);
    clamp(if off < 0.0 { -beyond } else { beyond }, -1.0, 1.0)
}

/// What the inertial sensor says, for the law.
pub fn felt(step: &Step<'_>) -> Felt {
    let motion = step.inputs.motion.unwrap_or_default();
    Felt {
        q: motion.q,
        rate: motion.rate,
        carried: step.context.support.resting(),
    }
}

impl Behaviour for Hold {
    fn advance(&mut self, step: &mut Step<'_>) {
        // A silent inertial sensor stops the rotors within some steps; until then the last setpoint stands.
        if let (Some(estimate), Some(_)) = (step.inputs.position, step.inputs.motion) {
            self.step(&estimate, step);
        }
        if approach::asked(step)
            && step.context.noted().is_none()
            && let Some(why) = approach::obstacle(step)
        {
            step.context.note(Some(why));
        }
    }

    fn rotors(&self, _: &Context, _: &Inputs) -> Setpoint {
        self.wanted
    }

    fn reason(&self, context: &Context, inputs: &Inputs, _: ArmingInhibits) -> Option<Reason> {
        let stale = self.place.adrift.then_some(Reason::PositionStale);
        stale.or_else(|| context.reason(inputs, true))
    }
}
