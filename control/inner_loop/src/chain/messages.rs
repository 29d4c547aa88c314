//! Messages of the last two stages of the flight step.

use crate::allocation::desaturation::Given;
use crate::allocation::wrench::{PerArm, Wrench};
use crate::attitude::rate_loop::Feedback;
use crate::chain::spin::Spin;
use crate::chain::static_thrust::StaticThrust;
use crate::maths::scalar::cos;

/// Demand of control on the mixer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Demand {
    /// Rotors stopped.
    #[default]
    Stop,
    /// Rotors at idle.
    Idle,
    /// Test of one motor.
    Spin(Spin),
    /// Test of one rotor or all with propellers on.
    StaticThrust(StaticThrust),
    /// A wrench, yaw included.
    Wrench(Wrench),
    /// A wrench on the pipe: yaw is given up, and sensors do not correct arms that do not hang free.
    Resting(Wrench),
}

/// Result of the mixer.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MixOutput {
    /// The rotors run.
    pub running: bool,
    /// Thrust demanded of each rotor, N.
    pub thrusts: PerArm<f32>,
    /// Motor commands, 0..1, battery compensated.
    pub commands: PerArm<f32>,
    /// Share given of the demanded yaw, thrust (relative to the range left) and roll/pitch, 0..1.
    pub given: Given,
    /// Yaw is given up: the arms' tilt leaves no authority.
    pub yaw_gated: bool,
    /// Estimated tilt of each arm, rad.
    pub tilt: PerArm<f32>,
    /// Tilt bias of each arm, rad.
    pub tilt_bias: PerArm<f32>,
    /// An arm is outside its model's range.
    pub tilt_fault: bool,
}

impl MixOutput {
    /// Demanded thrust along body -z, N; 0 while the rotors stand.
    pub fn lift(&self) -> f32 {
        if !self.running {
            return 0.0;
        }
        lift(&self.thrusts, &self.tilt)
    }

    /// Demanded roll moment of rotors at `lever` m beside the middle, right side down positive, N m; 0 while they stand.
    pub fn roll(&self, lever: f32) -> f32 {
        let [front_left, rear_left, front_right, rear_right] = self.thrusts;
        if self.running {
            lever * (front_left + rear_left - front_right - rear_right)
        } else {
            0.0
        }
    }

    /// Feedback for the rate loop.
    #[inline(always)]
    pub const fn feedback(&self) -> Feedback {
        Feedback {
            roll_pitch: self.given.roll_pitch,
            yaw: self.given.yaw,
            yaw_gated: self.yaw_gated,
        }
    }
}

/// What rotors that give `thrusts` (N) on arms at `tilt` (rad) push along body -z, N.
pub fn lift(thrusts: &PerArm<f32>, tilt: &PerArm<f32>) -> f32 {
    let arms = thrusts.iter().zip(tilt);
    arms.map(|(thrust, tilt)| thrust * cos(*tilt)).sum()
}
