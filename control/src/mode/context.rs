//! State that outlives a mode: parameters, the pilot's switches, evidence of support and lean, dangers, the collective.

use super::inputs::Inputs;
use super::inputs::actuator_tests::ActuatorTests;
use super::inputs::auto_perch::AutoPerch;
use super::inputs::dangers::Dangers;
use super::inputs::remote::{self, Remote};
use super::reason::Reason;
use super::shared::collective::Collective;
use super::shared::ground_probe::GroundProbe;
use super::shared::on_pipe::held;
use super::shared::power_up_grip::PowerUpGripCheck;
use crate::arming::{ArmingInhibit, ArmingInhibits, Checks, Gesture, GestureWatch};
use crate::contact::contact_force::{ContactForce, InertialSample};
use crate::contact::crown_offset::{CrownOffset, CrownSide};
use crate::contact::fall::Fall;
use crate::contact::lean::Lean;
use crate::gripper::clamp_command::ClampCommand;
use crate::gripper::retained_grip::GripMemory;
use crate::maths::hold_timer::HoldTimer;
use crate::maths::scalar::clamp;
use crate::navigation::estimate::Estimate;
use crate::oscillation::Oscillation;
use crate::params::Params;
use crate::pilot::rc::Sticks;
use crate::pilot::remote::RemoteOrder;
use crate::position_hold::gains::{Gains, HoldGains};
use crate::position_hold::{self, PositionHold};
use crate::thrust_factor::{Air, ThrustLearning, ThrustSample};

/// Time constant of learning gravity at rest, s, and bounds, m/s²: a part's bias of some 40 mg.
const GRAVITY_TIME: f32 = 0.5;
const GRAVITY_BOUNDS: (f32, f32) = (9.4, 10.2);
/// Least pace of loops that a hold flies over: that for motors of 0.20 s, the slowest that were flown.
const LEAST_PACE: f32 = 0.7;
/// Display time of a reason, s.
const NOTE_TIME: f32 = 10.0;

/// View of one step for states and guards.
#[derive(Debug)]
pub struct Step<'a> {
    pub context: &'a mut Context,
    pub inputs: &'a Inputs,
    /// Time since the last step, s.
    pub dt: f32,
}

/// History of the perch switch.
#[derive(Clone, Copy, Debug)]
pub struct PerchSwitch {
    /// Off since the last try: turning it on starts the next.
    pub seen_off: bool,
    /// On since the arms closed: turning it off opens them.
    pub seen_on: bool,
    /// On since power-up: the arms stay as they are until the pilot has moved it.
    pub left_on: bool,
    /// Time since it was turned off, s.
    pub off: HoldTimer,
}

impl PerchSwitch {
    /// Requires a new turn of the switch if its meaning has `changed` without the pilot.
    pub fn forget(&mut self, changed: bool) {
        self.seen_off &= !changed;
        self.seen_on &= !changed;
    }
}

/// State that outlives a mode.
#[derive(Clone, Debug)]
pub struct Context {
    pub params: Params,
    hold_gains: HoldGains,
    pub oscillation: Oscillation,
    /// The vehicle has swung in a hold since it left the ground: it holds gently.
    pub has_swung: bool,
    pub thrust: ThrustLearning,
    /// Time in this mode, s.
    pub since: f32,
    pub contact_force: ContactForce,
    pub dangers: Dangers,
    gestures: GestureWatch,
    /// The gesture completed in this step.
    pub gesture: Option<Gesture>,
    /// Last throttle: held when the radio is lost on the pipe.
    pub throttle: f32,
    /// The arm switch was off since power-up.
    arm_seen_off: bool,
    pub perch_switch: PerchSwitch,
    /// The hold switch was off since the last hold.
    pub hold_seen_off: bool,
    pub power_up_grip: PowerUpGripCheck,
    pub lean: Lean,
    pub fall: Fall,
    pub crown_offset: CrownOffset,
    /// Acceleration along world down, m/s².
    pub accel_down: f32,
    pub collective: Collective,
    pub ground_probe: GroundProbe,
    /// Number of times that the arms have tightened since they closed.
    pub tightened: u8,
    pub actuator_tests: ActuatorTests,
    pub remote: Remote,
    pub auto_perch: AutoPerch,
    /// A reason and its remaining display time, s.
    note: (Option<Reason>, f32),
    /// Specific force at rest, m/s².
    gravity: f32,
}

impl Context {
    /// A vehicle whose last run has left this [thrust factor](crate::thrust_factor), if any.
    pub fn new(params: &Params, hold_gains: &HoldGains, thrust_factor: Option<f32>) -> Self {
        Self {
            params: *params,
            hold_gains: *hold_gains,
            oscillation: Oscillation::default(),
            has_swung: false,
            thrust: ThrustLearning::new(params, thrust_factor),
            since: 0.0,
            contact_force: ContactForce::new(params),
            dangers: Dangers::default(),
            gestures: GestureWatch::default(),
            gesture: None,
            throttle: 0.0,
            arm_seen_off: false,
            perch_switch: PerchSwitch {
                seen_off: false,
                seen_on: false,
                left_on: true,
                off: HoldTimer::default(),
            },
            hold_seen_off: false,
            power_up_grip: PowerUpGripCheck::default(),
            lean: Lean::new(params),
            fall: Fall::default(),
            crown_offset: CrownOffset::default(),
            accel_down: 0.0,
            collective: Collective::default(),
            ground_probe: GroundProbe::default(),
            tightened: 0,
            actuator_tests: ActuatorTests::default(),
            remote: Remote::default(),
            auto_perch: AutoPerch::default(),
            note: (None, 0.0),
            gravity: crate::maths::scalar::GRAVITY,
        }
    }

    /// Takes in the inputs; learns gravity while the rotors are locked, and their thrust in free air.
    pub fn observe(&mut self, i: &Inputs, air: Air, dt: f32) {
        let at_rest = air == Air::Locked;
        self.since = clamp(self.since + dt, 0.0, 1e6);
        self.note.1 -= dt;
        self.gesture = self
            .gestures
            .step(i.sticks.as_ref(), self.params.throttle_low, dt);
        if let Some(s) = i.sticks {
            self.throttle = clamp(s.throttle, 0.0, 1.0);
            self.arm_seen_off |= !s.arm_switch;
            self.hold_seen_off |= !s.hold_switch;
            let perch = &mut self.perch_switch;
            perch.seen_off |= !s.perch_switch;
            perch.off.step(!s.perch_switch, dt);
            perch.left_on &= s.perch_switch;
            perch.seen_on |= s.perch_switch && !perch.left_on;
        }
        let down = i.motion.map_or(-self.gravity, |m| m.q.rotate(m.accel).z);
        if at_rest && i.motion.is_some() {
            // Measured at rest: otherwise the bias would add up in the sink rate.
            let seen = clamp(-down, GRAVITY_BOUNDS.0, GRAVITY_BOUNDS.1);
            self.gravity += (seen - self.gravity) * dt / (dt + GRAVITY_TIME);
        }
        let sample = i.motion.map(|m| InertialSample {
            specific_force_z: m.accel.z,
            down: down + self.gravity,
            rate: m.rate.norm(),
            lift: i.lift,
        });
        self.contact_force.step(sample, dt);
        let thrust = sample.map(|s| ThrustSample {
            specific_force_z: s.specific_force_z,
            lift: s.lift,
            sink: self.contact_force.sink(),
            resting: self.contact_force.resting(),
        });
        self.thrust.step(air, thrust, dt);
        self.crown_offset
            .step(i.lift, i.roll_moment, &self.contact_force, dt);
        self.accel_down = sample.map_or(0.0, |f| f.down);
        self.fall.step(self.accel_down, &self.contact_force, dt);
        self.lean
            .step(i.motion, &self.contact_force, self.collective.now(), dt);
        self.dangers.step(i, &self.params, dt);
        self.oscillation.step(i.motion.map(|m| m.rate), dt);
        self.has_swung &= !at_rest;
    }

    /// The motors are fast enough for a hold.
    pub fn motors_follow(&self) -> bool {
        self.hold_gains.usual.pace >= LEAST_PACE
    }

    /// Goes on with gentle loops until it is disarmed, and says so.
    pub fn swing(&mut self) {
        self.oscillation.forget();
        self.has_swung = true;
        self.note(Some(Reason::Swings));
    }

    fn hold_gains(&self) -> &Gains {
        if self.has_swung {
            &self.hold_gains.gentle
        } else {
            &self.hold_gains.usual
        }
    }

    /// Sets the gesture that `order` stands for.
    pub fn obey(&mut self, order: RemoteOrder) {
        self.gesture = remote::gesture(order).or(self.gesture);
        self.remote.kill = order == RemoteOrder::Kill;
        if self.gesture == Some(Gesture::Disarm) {
            self.actuator_tests.stop();
        }
    }

    /// Shows `why` for [`NOTE_TIME`].
    pub fn note(&mut self, why: Option<Reason>) {
        self.note = (why, NOTE_TIME);
    }

    pub fn noted(&self) -> Option<Reason> {
        self.note.0.filter(|_| self.note.1 > 0.0)
    }

    /// The reason shown beside most modes; `radio`: include its loss.
    pub fn reason(&self, i: &Inputs, radio: bool) -> Option<Reason> {
        let note = self.noted();
        if let Some(battery) = self.dangers.battery() {
            Some(battery)
        } else if radio && i.sticks.is_none() {
            Some(Reason::RADIO_LOST)
        } else if note.is_none() && self.dangers.line_silent() {
            Some(Reason::LINE_SILENT)
        } else {
            note
        }
    }

    /// Side of the vehicle on which the crown lies, while it rests beside it.
    pub fn crown_side(&self) -> Option<Reason> {
        self.crown_offset.side().map(|side| match side {
            CrownSide::Left => Reason::CrownLeft,
            CrownSide::Right => Reason::CrownRight,
        })
    }

    /// Everything against arming with this grip.
    pub fn inhibits(&self, i: &Inputs, grip_memory: GripMemory) -> ArmingInhibits {
        let chosen = grip_memory
            .arms()
            .unwrap_or(i.sticks.unwrap_or_default().arms)
            .mask();
        // Opening arms still pull at the pipe, and running rotors would pull at these arms: only arms that are proven
        // free count.
        let arms_closed = match grip_memory {
            GripMemory::Open => !i.grip.is_some_and(|grip| grip.released),
            GripMemory::Controlled(_) | GripMemory::HeldByGears(_) => !self.grasps(i, grip_memory),
            GripMemory::Unknown => true,
        };
        let inhibits = Checks {
            calibrated: i.motion.is_some_and(|m| m.calibrated && !m.leans_unseen()),
            cos_tilt: i.motion.map(|m| m.q.down_in_body().z),
            sticks: i.sticks,
            switch_seen_off: self.arm_seen_off,
            battery: i.battery,
            fsr_fault: i
                .fsr_fault
                .iter()
                .zip(chosen)
                .any(|(&fault, chosen)| fault && chosen),
            late: i.late,
            hardware: match i.servo_trouble() {
                Some(why) => i.hardware.with(why),
                None => i.hardware,
            },
            arms_closed,
        }
        .inhibits(&self.params);
        // Sensor ranges of unused arms do not matter.
        let inhibits = ArmingInhibit::FSR_RANGE
            .into_iter()
            .zip(chosen)
            .filter(|(_, chosen)| !chosen)
            .fold(inhibits, |all, (range, _)| all.without(range));
        if grip_memory.arms().is_some() {
            // Armed on the pipe, the rotors stay stopped. The perch switch is on there, and turning it off opens the
            // arms. A broken servo supply cannot be repaired there, and the servos should open the arms before they
            // lose power.
            inhibits
                .without(ArmingInhibit::PerchSwitchOn)
                .without(ArmingInhibit::BrownOut)
                .without(ArmingInhibit::ServoBatterySilent)
                .without(ArmingInhibit::ServoBatteryLow)
        } else {
            inhibits
        }
    }

    /// True if the arms of `grip_memory` hold something. For arms held by their gears some pressure is enough: a weak
    /// servo yields until its friction carries the load.
    pub fn grasps(&self, i: &Inputs, grip_memory: GripMemory) -> bool {
        match grip_memory {
            GripMemory::Controlled(arms) => held(i.grip, arms, &self.params),
            GripMemory::HeldByGears(arms) => i.grip.is_some_and(|grip| {
                let mut arms = grip.arms.iter().zip(arms.mask());
                arms.any(|(arm, chosen)| chosen && arm.pressure > self.params.release_pressure)
            }),
            GripMemory::Open | GripMemory::Unknown => false,
        }
    }

    /// Grip of a vehicle at rest: the perch switch, on and off again, opens the arms.
    pub fn after_switch(&self, sticks: Option<Sticks>, grip_memory: GripMemory) -> GripMemory {
        let off = sticks.is_some_and(|s| !s.perch_switch);
        if grip_memory.arms().is_some() && off && self.perch_switch.seen_on {
            GripMemory::Open
        } else {
            grip_memory
        }
    }

    /// Replaces a closing `command` by the number of tightenings made so far.
    pub fn tight(&self, command: ClampCommand) -> ClampCommand {
        match command {
            ClampCommand::Close { arms } if self.tightened > 0 => ClampCommand::Tighten {
                arms,
                times: self.tightened,
            },
            other => other,
        }
    }

    /// Collective at full throttle, N, with the thrust learnt in flight.
    pub fn full_thrust(&self) -> f32 {
        4.0 * self.params.thrust_max * self.thrust.now().value
    }

    /// Collective on the pipe while the arms close, N: `perch_lift` of the weight, limited to the pilot's throttle;
    /// autonomous perching ignores the throttle, which is centred.
    pub fn set_down_thrust(&self) -> f32 {
        let most = self.params.perch_lift * self.contact_force.weight();
        if self.auto_perch.active {
            most
        } else {
            clamp(self.throttle * self.full_thrust(), 0.0, most)
        }
    }
}

impl Step<'_> {
    /// Motion of the body, for the position hold.
    pub fn body_motion(&self) -> position_hold::BodyMotion {
        let motion = self.inputs.motion.unwrap_or_default();
        position_hold::BodyMotion {
            q: motion.q,
            rate: motion.rate,
            carried: self.context.contact_force.resting(),
        }
    }

    /// A position hold at the present position.
    pub fn position_hold(&mut self, estimate: &Estimate) -> PositionHold {
        self.context.oscillation.forget();
        let (motion, context) = (self.body_motion(), &self.context);
        let full = context.full_thrust();
        PositionHold::begin(&context.params, context.hold_gains(), full, estimate, &motion)
    }

    /// Goes on gently with a `hold` in which the vehicle swings, and says so.
    pub fn calm(&mut self, hold: &mut PositionHold) {
        if self.context.oscillation.swings() {
            self.context.swing();
            hold.change(self.context.hold_gains());
        }
    }

    pub fn grip_proven(&self) -> bool {
        self.inputs.grip.is_some_and(|g| g.proven)
    }

    pub fn arms_free(&self) -> bool {
        self.inputs.grip.is_some_and(|g| g.released)
    }

    /// One step of the power-up grip check; returns the updated grip.
    pub fn check_power_up_grip(&mut self, grip_memory: GripMemory) -> GripMemory {
        let Context {
            power_up_grip,
            params,
            ..
        } = &mut *self.context;
        power_up_grip.decide(grip_memory, self.inputs, params, self.dt)
    }
}
