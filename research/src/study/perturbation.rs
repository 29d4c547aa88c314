//! The plant's moments after a small change of thrust with settled arms, from its parts alone.

use glam::{DQuat, DVec3};
use sophie_control::allocation::wrench::PerArm;

use sophie_sim::plant::body::{Body, BodySpec};
use sophie_sim::plant::contact::Pose;
use sophie_sim::plant::hinged::link::{Arm, ArmSpec};
use sophie_sim::plant::load::Load;
use sophie_sim::plant::rotor::{Rotor, RotorSpec};
use sophie_sim::plant::{GRAVITY, STEP};

/// Settling time of the arms, s: 20 periods of a heavily damped mode.
const REST: f64 = 2.0;
/// Meanwhile; the equilibrium does not depend on it.
const DAMPING: f64 = 0.7;

/// A vehicle under trial thrusts.
#[derive(Clone, Copy, Debug)]
pub struct Trial {
    /// Infill of the arms, %.
    pub infill: f64,
    /// Gain on the elastic term of Eq. 1; 0 for rigid arms.
    pub gain_k: f64,
    /// +1 for configuration B, -1 for A.
    pub chi: f64,
}

impl Trial {
    /// Force along -z (N) and moments (N·m) at `thrusts` (N) with settled arms.
    #[must_use]
    pub fn wrench(&self, thrusts: PerArm<f64>) -> [f64; 4] {
        let spec = BodySpec::default();
        let body = Body::whole(&spec);
        let rotor = RotorSpec::default();
        // The plant has no rigid arms: nominal ones are held level.
        let arm_spec = ArmSpec::new(self.infill, self.gain_k.max(1e-3), 1.0, 0.0, DAMPING);
        let mut arms: PerArm<Arm> = std::array::from_fn(|i| Arm::new(i, arm_spec));
        for (arm, thrust) in arms.iter_mut().zip(thrusts) {
            arm.tilt = 0.0;
            arm.integrate(0.0, 0.0);
            if self.gain_k > 0.0 {
                let inertia = sophie_sim::plant::hinged::link::TIP_MASS
                    * sophie_sim::plant::contact::ARM_LENGTH
                    * sophie_sim::plant::contact::ARM_LENGTH;
                for _ in 0..(REST / STEP) as usize {
                    arm.load(thrust, 0.0, DVec3::new(0.0, 0.0, GRAVITY), false);
                    arm.integrate(STEP, arm.generalised / inertia);
                }
            }
            arm.load(thrust, 0.0, DVec3::ZERO, false);
        }
        let drag: DVec3 = arms
            .iter()
            .enumerate()
            .zip(thrusts)
            .map(|((i, arm), thrust)| Rotor::turning(i, self.chi, rotor, thrust).drag_moment(arm.normal()))
            .sum();
        let pose = Pose {
            position: DVec3::ZERO,
            attitude: DQuat::IDENTITY,
            velocity: DVec3::ZERO,
            omega: DVec3::ZERO,
        };
        let a = body.accelerate(
            &pose,
            Load {
                force: DVec3::ZERO,
                moment: drag,
            },
            DVec3::ZERO,
            arms.each_ref(),
        );
        let moment = a.angular * DVec3::from_array(spec.inertia);
        [-a.linear.z * spec.mass, moment.x, moment.y, moment.z]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stiff_level_arms_have_the_stiff_frame_s_moments() {
        let stiff = Trial {
            infill: 6.9,
            gain_k: 0.0,
            chi: 1.0,
        };
        // 0.1 N more on 1 and 4, less on 2 and 3: 4 · 0.1 N · 16 mm about z, nothing else.
        let [lift, roll, pitch, yaw] = stiff.wrench([4.1, 3.9, 3.9, 4.1]);
        assert!((lift - 16.0).abs() < 1e-9 && roll.abs() < 1e-9 && pitch.abs() < 1e-9);
        assert!((yaw - 0.4 * 0.016).abs() < 1e-9, "{yaw}");
    }
}
