//! The hovering vehicle's response to a moment of one step, through allocation, thrust curve and plant.
//!
//! The loop about one axis is open, the two others stay closed as in flight: left to themselves arms that differ would turn
//! the vehicle about yaw within seconds, and a turning body precesses at a few tenths of a hertz, which it never does in
//! flight.

use glam::DVec3;
use sophie_control::allocation::mixer::Allocation;
use sophie_control::allocation::wrench::Wrench;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{
    Attitude, CONTROL_RATE_HZ, Command, Control, Demand, MixOutput, Mixing, Surroundings,
};
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::params::Params;
use sophie_control::position_hold::BodyMotion;
use sophie_mixers::Mixer;

use super::response::Response;
use crate::plant::air::AirSpec;
use crate::plant::air::wind::WindSpec;
use crate::plant::contact::ARM_LENGTH;
use crate::plant::{Actuators, GRAVITY, Plant, STEP};
use crate::scenario::{Scenario, World};

/// Names of the axes.
pub const AXES: [&str; 3] = ["roll", "pitch", "yaw"];

/// s, and plant steps in it.
const DT: f64 = 1.0 / CONTROL_RATE_HZ as f64;
const PLANT_STEPS: u32 = (DT / STEP) as u32;
/// Settling of rotors and arms in hover, steps.
const TRIM_STEPS: u64 = 3000;
/// Just enough to hold an attitude meanwhile, 1/s, whatever gains are judged.
const GENTLE: [f32; 4] = [1.5, 3.0, 0.5, 1.0];
/// Steps per reading of the arm sensors.
const ARM_STEPS: u64 = 10;
/// Largest share of full thrust for hover: beyond it rotors cannot respond, and the thrust row reports it.
const HOVER_SHARE: f64 = 0.9;
/// Largest impulses, N·m for 1 ms: 0.7 N a rotor about roll and pitch, less than yaw's limit on a stiff frame; and
/// their largest share of the rotors' room.
const PUSH: [f64; 3] = [0.5, 0.5, 0.05];
const ROOM_SHARE: f64 = 0.2;
/// Longest response, steps, and the share of its largest change at which it ends.
const LONGEST: usize = 5000;
const ENDED: f64 = 1e-3;
/// Steps to stay below it: two periods of the slowest arm mode, 1 Hz, fit in.
const QUIET: usize = 300;
/// Position of the vehicle, m, NED: off ground and pipe.
const PLACE: DVec3 = DVec3::new(0.0, 0.0, -1000.0);

#[cfg(test)]
thread_local! {
    /// Steps of hovering vehicles, nearly all of what a check costs.
    pub static STEPS: std::cell::Cell<u64> = const { std::cell::Cell::new(0) };
}

/// A vehicle that hovers in still air.
#[derive(Clone)]
pub struct Hovering {
    plant: Plant,
    control: Control,
    mixing: Mixing<Mixer>,
    mix: MixOutput,
    params: Params,
    /// Rotor wrench of the settled hover.
    wrench: Wrench,
    /// Scale of the impulses for which the rotors have room.
    push: f64,
    at_us: u64,
}

impl Hovering {
    /// Held level with gentle gains until arms and rotors have settled.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        Self::carrying(scenario, 1.0)
    }

    /// The same with rotors that carry the `share` of the weight, above 0, as beside a pipe.
    #[must_use]
    pub fn carrying(scenario: &Scenario, share: f64) -> Self {
        let calm = Scenario {
            world: World {
                gust_force: 0.0,
                gust_moment: 0.0,
                steady_wind: 0.0,
                air: AirSpec {
                    wind: WindSpec::default(),
                    ..scenario.world.air
                },
                ..scenario.world.clone()
            },
            ..scenario.clone()
        };
        let v = &scenario.vehicle;
        let mut plant = calm.plant();
        plant.place(PLACE, DVec3::ZERO);
        let mixer = Mixer::new(scenario.mixer, v.configuration, &scenario.params);
        let thrust = (share * v.body.mass * GRAVITY).min(HOVER_SHARE * 4.0 * v.rotor.thrust_max);
        let mut hovering = Self {
            plant,
            control: gentle(&scenario.params),
            mixing: Mixing::new(&scenario.params, mixer),
            mix: MixOutput::default(),
            params: scenario.params,
            wrench: Wrench {
                thrust: thrust as f32,
                ..Wrench::default()
            },
            push: 0.0,
            at_us: 0,
        };
        hovering.settle();
        let share = (hovering.plant.battery_voltage() / f64::from(scenario.params.battery_nominal)).min(1.0);
        let most = v.rotor.thrust_max * share * share;
        let room = (most - 0.25 * thrust).max(0.0) * ROOM_SHARE * 4.0 * ARM_LENGTH;
        hovering.push = (room / PUSH[0]).clamp(0.02, 1.0);
        hovering
    }

    fn settle(&mut self) {
        for step in 0..TRIM_STEPS {
            if step.is_multiple_of(ARM_STEPS) {
                let tilt = self.plant.tilt();
                for (arm, tilt) in tilt.into_iter().enumerate() {
                    self.mixing.allocation.tilt_mut().correct(arm, tilt as f32);
                }
            }
            self.wrench = self.held();
            self.step(self.wrench);
        }
    }

    /// Other loops, that hold the present attitude.
    pub(super) fn take_over(&mut self, control: Control) {
        self.control = control;
    }

    /// True attitude and rates.
    pub(super) fn motion(&self) -> BodyMotion {
        let pose = self.plant.pose();
        let [x, y, z, w] = pose.attitude.to_array().map(|q| q as f32);
        BodyMotion {
            q: Quat { w, x, y, z },
            rate: Vec3::from(pose.omega.as_vec3().to_array()),
            carried: false,
        }
    }

    /// `steps` of 1 ms towards roll and pitch of `setpoint`, with the thrust of the settled hover; returns the velocity that they
    /// give, m/s, NED.
    pub(super) fn fly(&mut self, setpoint: Setpoint, steps: usize) -> DVec3 {
        let [roll, pitch, ..] = setpoint.numbers();
        let at_us = self.at_us;
        (0..steps).fold(DVec3::ZERO, |gained, _| {
            let wrench = self.towards(roll, pitch, at_us);
            gained + self.step(wrench)
        })
    }

    /// Moments that hold it level.
    fn held(&mut self) -> Wrench {
        self.towards(0.0, 0.0, 1)
    }

    /// Moments of the loops towards roll and pitch, rad, of a setpoint at `at_us`.
    fn towards(&mut self, roll: f32, pitch: f32, at_us: u64) -> Wrench {
        let BodyMotion { q, rate, .. } = self.motion();
        let attitude = Attitude {
            q,
            rate,
            calibrated: true,
            dt: DT as f32,
            ..Attitude::default()
        };
        let command = Command {
            setpoint: Setpoint::Angle {
                roll,
                pitch,
                yaw_rate: 0.0,
                thrust: self.wrench.thrust,
            },
            at_us,
            gentle: false,
        };
        match self.control.step(&attitude, &command, &self.mix.feedback()) {
            Demand::Wrench(wrench) => wrench,
            _ => self.wrench,
        }
    }

    /// A step with `moment` (N m) beside the settled one about `axis`, and the others held.
    fn pushed(&mut self, axis: usize, moment: f32) {
        let (settled, mut wrench) = (self.wrench, self.held());
        match axis {
            0 => wrench.roll = settled.roll + moment,
            1 => wrench.pitch = settled.pitch + moment,
            _ => wrench.yaw = settled.yaw + moment,
        }
        self.step(wrench);
    }

    /// Returns the velocity that the step gives, m/s, NED.
    fn step(&mut self, wrench: Wrench) -> DVec3 {
        #[cfg(test)]
        STEPS.set(STEPS.get() + 1);
        self.at_us += 1000;
        let surroundings = Surroundings {
            battery_ratio: Some(self.plant.battery_voltage() as f32 / self.params.battery_nominal),
            thrust_root: None,
            arms: None,
        };
        self.mixing
            .step(self.at_us, &Demand::Wrench(wrench), &surroundings, &mut self.mix);
        let actuators = Actuators {
            motors: self.mix.commands.map(f64::from),
            ..Actuators::default()
        };
        for _ in 0..PLANT_STEPS {
            self.plant.step(&actuators);
        }
        // Drag on the speed that a lean builds up would turn the vehicle over within seconds; the loops prevent that.
        let gained = self.plant.pose().velocity;
        self.plant.place(PLACE, DVec3::ZERO);
        gained
    }

    /// Body rate about `axis` (0 to 2) after 1 N·m in one step, rad/(s·N·m): half the difference of opposite pushes,
    /// which cancels common drift.
    #[must_use]
    pub fn response(&self, axis: usize) -> Response {
        let push = PUSH[axis] * self.push;
        let (mut there, mut back) = (self.clone(), self.clone());
        let (mut answer, mut largest, mut quiet) = (Vec::new(), 0.0_f64, 0);
        let mut last = 0.0;
        while answer.len() < LONGEST && quiet < QUIET {
            let now = if answer.is_empty() { push as f32 } else { 0.0 };
            there.pushed(axis, now);
            back.pushed(axis, -now);
            let difference = there.plant.pose().omega[axis] - back.plant.pose().omega[axis];
            let rate = 0.5 * difference / push;
            let change = (rate - last).abs();
            last = rate;
            largest = largest.max(change);
            quiet = if change < ENDED * largest { quiet + 1 } else { 0 };
            answer.push(rate);
        }
        Response::of(&answer)
    }
}

/// Loops of [`GENTLE`] gains.
fn gentle(p: &Params) -> Control {
    let [attitude_p, rate_p, attitude_yaw_p, rate_yaw_p] = GENTLE;
    Control::new(&Params {
        attitude_p: attitude_p.min(p.attitude_p),
        rate_roll_p: rate_p.min(p.rate_roll_p),
        rate_pitch_p: rate_p.min(p.rate_pitch_p),
        attitude_yaw_p: attitude_yaw_p.min(p.attitude_yaw_p),
        rate_yaw_p: rate_yaw_p.min(p.rate_yaw_p),
        rate_d: 0.0,
        ..*p
    })
}
