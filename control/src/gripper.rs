//! The gripper's controller: contact pressure in, tendon force out.
//!
//! [`Gripper::step`] is called at 100 Hz by the task `clamp`, with the measured time since the step before (s). Forces
//! are along the tendon (N), pressures on the sensor (Pa), tilts positive with the arm's tip up (rad). A late step
//! acts later on the pressure by as much; when steps cease, the servos are held after 200 ms and with them the grip.
//!
//! Each arm goes through three phases. It is bent down at a steady speed, its force rising as its stiffness
//! demands, until the sensor feels something. Then the force is set to what the tendon really has, which is
//! less than what was asked while the arm still moved, and a PID leads the pressure along a reference that
//! approaches the target from below. On release the force falls to nothing at a limited rate.
//!
//! Two things are known beforehand and fed forward: the arm's stiffness sets the rise, and the thrust of the
//! arm's rotor bends it away from the pipe with arm_d T, which the tendon meets with arm_d/h T. So the
//! pressure hardly moves when the rotors stop.
//!
//! | word | meaning |
//! |---|---|
//! | force | what is asked of a tendon |
//! | tension | what its servo can be giving, by angle and tilt: it lags behind the force |
//! | lag | force less tension |
//! | touch | a pressure above the sensor's threshold |
//! | hold position | the servo stays where it is, whatever the force: until the tension is known after a restart |
//! | proven | every closing arm holds, and all were within the tolerance at once for the dwell time |
//! | released | every arm is free: light, its tendon slack, its servo back at its release position |

mod arm;
mod bend_watch;
mod ceiling_watch;
mod config;
mod input;
mod pressure_loop;
#[cfg(test)]
mod tests;

pub use self::arm::ArmGripper;
pub use self::config::Config;
pub use self::input::{ArmInput, Pressure};
use crate::grip::{ArmGrip, ArmState};
use crate::grip_fault::GripFault;
use crate::math;
use crate::wrench::PerArm;

/// Pressure that counts as touching, Pa: above the sensor's threshold of 0.1 N (69 Pa on 1444 mm²).
const TOUCH_PRESSURE: f32 = 100.0;
/// Least force of a closed arm, N: at 0 the servo would pay out to its release position.
const FORCE_MIN: f32 = 1.0;

/// What the controller puts out for one arm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArmOutput {
    /// What is known of the grip, with the force asked of the tendon.
    pub grip: ArmGrip,
    /// The servo is to stay where it is: a restart left it there.
    pub hold_position: bool,
}

/// What the controller puts out for all arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GripperOutput {
    /// Arm by arm.
    pub arms: PerArm<ArmOutput>,
    /// Every chosen arm holds (there is at least one), and all were within the tolerance at once for the dwell time.
    pub proven: bool,
    /// Every arm is free.
    pub released: bool,
}

/// The controller of the four arms.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gripper {
    arms: PerArm<ArmGripper>,
    /// Time for which every chosen arm has been within the tolerance at once, s.
    together: f32,
    proven: bool,
}

impl Gripper {
    /// The loops of closed arms after a restart; see [`ArmGripper::resume`]. Arms without a force were not closed.
    pub fn resume(force: PerArm<f32>, fault: PerArm<Option<GripFault>>) -> Self {
        let mut arms = [ArmGripper::default(); 4];
        for ((arm, force), fault) in arms.iter_mut().zip(force).zip(fault) {
            if force > 0.0 {
                *arm = ArmGripper::resume(force, fault);
            }
        }
        Self {
            arms,
            ..Self::default()
        }
    }

    /// One step of `dt` s.
    pub fn step(&mut self, cfg: &Config, input: &PerArm<ArmInput>, dt: f32) -> GripperOutput {
        let mut out = GripperOutput {
            released: true,
            ..GripperOutput::default()
        };
        let (mut holding, mut within) = (input.iter().any(|i| i.close), true);
        for ((arm, input), output) in self.arms.iter_mut().zip(input).zip(&mut out.arms) {
            let grip = arm.step(cfg, input, dt);
            *output = ArmOutput {
                grip,
                hold_position: arm.holds_position(),
            };
            holding &= !input.close || grip.state == ArmState::Holding;
            within &= !input.close || (grip.pressure - cfg.demand.pressure).abs() <= cfg.demand.tolerance;
            out.released &= arm.is_free(input.pressure);
        }
        // Once proven a grip is only doubted arm by arm: a push moves the pressures without loosening it.
        self.together = if within {
            math::clamp(self.together + dt, 0.0, 10.0)
        } else {
            0.0
        };
        self.proven = holding && (self.proven || self.together >= cfg.demand.dwell);
        out.proven = self.proven;
        out
    }
}
