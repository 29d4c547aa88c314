//! Gripper controller: contact pressure in, tendon force out.
//!
//! [`Gripper::step`] runs at 100 Hz in the task `clamp`. Forces are along the tendon (N), pressures on the sensor (Pa),
//! tilts positive with the tip up (rad). A late step delays the control; after 200 ms without a step the servos hold
//! their angle, and with it the grip.
//!
//! Each arm bends down steadily until its sensor detects a touch. The force is then set to the tendon's tension, which
//! lags in motion, and a PID controls the pressure along a reference that approaches the target from below. On release
//! the force falls at a limited rate.
//!
//! Two feed-forwards: the arm's stiffness sets the rate of rise, and a tendon force in proportion to the rotor's thrust
//! balances the thrust's bending of the arm off the pipe, so the pressure hardly changes when the rotors stop. A thrust
//! at the tip and a tendon along the arm bend a beam differently: two parameters give the ratio, for a free arm and on
//! the pipe.
//!
//! | word | meaning |
//! |---|---|
//! | force | asked of a tendon |
//! | tension | the servo's possible force on the tendon, by angle and tilt; it lags behind the force |
//! | lag | force less tension |
//! | touch | pressure above the sensor's threshold |
//! | hold position | the servo stays, whatever the force, until the tension is known after a restart |
//! | settled | the mean pressure is within the tolerance and hardly changes |
//! | proven | every closing arm holds, all were settled at once for the dwell time, and [fit](crate::gripper::grip_geometry) |
//! | released | every arm is free: light, tendon slack, servo back at its release position |

mod arm;
mod bend_watch;
mod ceiling_watch;
pub mod clamp_command;
mod config;
pub mod contact_pressure;
pub mod grip;
pub mod grip_fault;
pub mod grip_geometry;
mod input;
mod pressure_loop;
pub mod retained_grip;
pub mod tendon;
#[cfg(test)]
mod tests;

pub use self::arm::ArmGripper;
pub use self::bend_watch::{RESPONSE as RESPONSE_RANGE, tendon_stiffness};
pub use self::config::{Config, TIGHTENINGS, force_per_thrust};
pub use self::input::{ArmInput, Pressure};
use crate::allocation::wrench::PerArm;
use crate::gripper::grip::{ArmGrip, ArmState};
use crate::gripper::grip_fault::GripFault;
use crate::gripper::grip_geometry::{Laid, Misfit, lies_across, misfit};

/// Pressure of a touch, Pa: above the sensor's threshold of 0.1 N (69 Pa on 1444 mm²).
const TOUCH_PRESSURE: f32 = 100.0;
/// Least force of a closed arm, N: at 0 the servo would pay out to its release position.
const FORCE_MIN: f32 = 1.0;

/// Output for one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmOutput {
    /// Grip, with the force asked of the tendon.
    pub grip: ArmGrip,
    /// The servo must stay where a restart left it.
    pub hold_position: bool,
}

/// Output for all arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GripperOutput {
    /// Per arm.
    pub arms: PerArm<ArmOutput>,
    /// All chosen arms (at least one) hold, were settled together once, and are bent as round a pipe.
    pub proven: bool,
    /// Reason for which the geometry alone prevents the proof.
    pub misfit: Option<Misfit>,
    /// Every arm is free.
    pub released: bool,
    /// An arm pressed at power-on while its servo had no pulses: the tendons are wound, by an unknown angle.
    pub wound_at_power_on: bool,
}

/// Controller of the four arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gripper {
    arms: PerArm<ArmGripper>,
    /// All chosen arms were settled together in this closing.
    settled: bool,
    proven: bool,
    wound_at_power_on: bool,
}

impl Gripper {
    /// Resumes the loops of closed arms (those with a force) after a restart, with their learnt responses.
    pub fn resume(
        force: PerArm<f32>,
        fault: PerArm<Option<GripFault>>,
        response: PerArm<Option<f32>>,
    ) -> Self {
        let mut arms = [ArmGripper::default(); 4];
        let kept = force.into_iter().zip(fault).zip(response);
        for (arm, ((force, fault), response)) in arms.iter_mut().zip(kept) {
            if force > 0.0 {
                *arm = ArmGripper::resume(force, fault, response);
            }
        }
        Self {
            arms,
            ..Self::default()
        }
    }

    /// One step of `dt` s before the servos' first pulse, while their gears hold the arms as at power-on.
    pub fn step_without_pulses(&mut self, cfg: &Config, input: &PerArm<ArmInput>, dt: f32) -> GripperOutput {
        let out = self.step(cfg, input, dt);
        self.wound_at_power_on = out
            .arms
            .iter()
            .any(|arm| arm.grip.pressure > cfg.demand.release_pressure);
        GripperOutput {
            wound_at_power_on: self.wound_at_power_on,
            ..out
        }
    }

    /// One step of `dt` s.
    pub fn step(&mut self, cfg: &Config, input: &PerArm<ArmInput>, dt: f32) -> GripperOutput {
        let mut out = GripperOutput {
            released: true,
            wound_at_power_on: self.wound_at_power_on,
            ..GripperOutput::default()
        };
        // Arms that release one after another would turn the body about the last one: all tendons become slack
        // together.
        let opening = self.arms.iter().zip(input).filter(|(_, i)| !i.close);
        let most = opening.map(|(arm, _)| arm.force).fold(0.0, f32::max);
        let mut holding = input.iter().any(|i| i.close);
        let mut settled = holding;
        for ((arm, input), output) in self.arms.iter_mut().zip(input).zip(&mut out.arms) {
            let grip = arm.step(&cfg.releasing(arm.force, most), input, dt);
            *output = ArmOutput {
                grip,
                hold_position: arm.holds_position(),
            };
            holding &= !input.close || grip.state == ArmState::Holding;
            settled &= !input.close || arm.is_settled(cfg);
            out.released &= arm.is_free(input.pressure);
        }
        // An arm that closes moves the load of those that closed before it.
        self.settled = settled || self.settled && input.iter().any(|i| i.close);
        let laid = self.laid(cfg, input);
        if !self.proven && lies_across(&laid) {
            out.misfit = Some(Misfit::Oblique);
        }
        if holding && !self.proven && self.settled {
            out.misfit = misfit(&laid, cfg.pipe_bend);
            self.proven = out.misfit.is_none() && input.iter().all(|i| !i.close || i.tilt.is_some());
        }
        self.proven &= holding;
        out.proven = self.proven;
        out
    }

    /// The closed arms with a known tilt.
    fn laid(&self, cfg: &Config, input: &PerArm<ArmInput>) -> PerArm<Option<Laid>> {
        let mut laid = [None; 4];
        for ((slot, arm), input) in laid.iter_mut().zip(&self.arms).zip(input) {
            let relief = cfg.per_thrust * input.thrust;
            *slot = input.tilt.filter(|_| input.close).map(|tilt| Laid {
                tilt,
                force: arm.force - relief,
            });
        }
        laid
    }
}
