//! Attitude control: a quaternion P loop for the tilt, a leashed heading for yaw.
//!
//! The tilt setpoint is built on the heading that the vehicle has, not the one it should have: otherwise
//! a yaw error would leak roll into pitch.

use crate::filter::LowPass;
use crate::math;
use crate::params::Params;
use crate::vector::{Quat, Vec3};

/// Farthest that the heading setpoint may run ahead of the heading, rad.
const HEADING_LEASH: f32 = 0.5;
/// Time constant of the yaw stick's rate, s: torsion wants smooth commands.
const YAW_RATE_TAU: f32 = 0.3;

/// Wanted attitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeSetpoint {
    /// Roll, rad.
    pub roll: f32,
    /// Pitch, rad.
    pub pitch: f32,
    /// Yaw rate, rad/s.
    pub yaw_rate: f32,
}

/// The attitude loop's state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeLoop {
    p: f32,
    yaw_p: f32,
    cutoff: f32,
    rate_max: f32,
    yaw_rate_max: f32,
    roll: (LowPass, LowPass),
    pitch: (LowPass, LowPass),
    yaw_rate: LowPass,
    heading: f32,
}

impl AttitudeLoop {
    /// A loop that holds level.
    pub fn new(p: &Params) -> Self {
        Self {
            p: p.attitude_p,
            yaw_p: p.attitude_yaw_p,
            cutoff: p.setpoint_cutoff,
            rate_max: p.rate_max,
            yaw_rate_max: p.yaw_slew,
            roll: Default::default(),
            pitch: Default::default(),
            yaw_rate: LowPass::default(),
            heading: 0.0,
        }
    }

    /// Starts afresh from the attitude `q`: setpoints where the vehicle is, no jump on the first step.
    pub fn reset(&mut self, q: Quat) {
        let (roll, pitch, yaw) = q.to_euler();
        self.roll = (LowPass::at(roll), LowPass::at(roll));
        self.pitch = (LowPass::at(pitch), LowPass::at(pitch));
        self.yaw_rate = LowPass::at(0.0);
        self.heading = yaw;
    }

    /// Takes the present heading as the wanted one, while yaw is given up.
    pub fn capture_heading(&mut self, q: Quat) {
        self.heading = heading(q);
        self.yaw_rate = LowPass::at(0.0);
    }

    /// Body rates (rad/s) that lead from `q` to the setpoint; step time `dt` s.
    pub fn step(&mut self, q: Quat, setpoint: AttitudeSetpoint, dt: f32) -> Vec3 {
        let smooth = |f: &mut (LowPass, LowPass), x: f32| {
            let first = f.0.step(x, self.cutoff, dt);
            f.1.step(first, self.cutoff, dt)
        };
        let roll = smooth(&mut self.roll, setpoint.roll);
        let pitch = smooth(&mut self.pitch, setpoint.pitch);
        let now = heading(q);

        // The shortest turn from here to the wanted tilt, in body axes.
        let error = q.conjugate() * Quat::from_euler(roll, pitch, now);
        let gain = if error.w < 0.0 {
            -2.0 * self.p
        } else {
            2.0 * self.p
        };

        let yaw_rate = self.yaw_rate.step(
            math::clamp_abs(setpoint.yaw_rate, self.yaw_rate_max),
            1.0 / YAW_RATE_TAU,
            dt,
        );
        let ahead = math::wrap_pi(self.heading + yaw_rate * dt - now);
        let ahead = math::clamp_abs(ahead, HEADING_LEASH);
        self.heading = math::wrap_pi(now + ahead);
        let yaw = math::clamp_abs(yaw_rate + self.yaw_p * ahead, 2.0 * self.yaw_rate_max);

        // A heading rate turns about the world's vertical.
        let vertical = q.down_in_body() * yaw;
        Vec3::new(
            math::clamp_abs(gain * error.x + vertical.x, self.rate_max),
            math::clamp_abs(gain * error.y + vertical.y, self.rate_max),
            vertical.z,
        )
    }

    /// Roll, pitch and heading aimed at, rad, after the prefilter.
    pub const fn target(&self) -> Vec3 {
        Vec3::new(self.roll.1.value(), self.pitch.1.value(), self.heading)
    }
}

/// Heading of the attitude `q`, rad.
fn heading(q: Quat) -> f32 {
    math::atan2(2.0 * (q.w * q.z + q.x * q.y), 1.0 - 2.0 * (q.y * q.y + q.z * q.z))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn settled(q: Quat, setpoint: AttitudeSetpoint) -> Vec3 {
        let mut a = AttitudeLoop::new(&Params::default());
        a.reset(q);
        let mut rate = Vec3::ZERO;
        for _ in 0..2000 {
            rate = a.step(q, setpoint, 1e-3);
        }
        rate
    }

    #[test]
    fn the_rate_is_p_times_the_error() {
        let r = settled(
            Quat::IDENTITY,
            AttitudeSetpoint {
                roll: 0.1,
                ..Default::default()
            },
        );
        assert!(
            (r.x - 0.45).abs() < 0.01 && r.y.abs() < 0.01 && r.z.abs() < 0.02,
            "{r:?}"
        );
        let r = settled(
            Quat::IDENTITY,
            AttitudeSetpoint {
                pitch: -0.1,
                ..Default::default()
            },
        );
        assert!((r.y + 0.45).abs() < 0.01 && r.x.abs() < 0.01);
    }

    #[test]
    fn a_yaw_error_does_not_leak_into_pitch() {
        let mut a = AttitudeLoop::new(&Params::default());
        a.reset(Quat::IDENTITY);
        let turned = Quat::from_euler(0.0, 0.0, 0.6);
        let r = a.step(turned, AttitudeSetpoint::default(), 1e-3);
        assert!(r.x.abs() < 0.01 && r.y.abs() < 0.01);
        // Leashed: 0.5 rad at 1.2 1/s, back towards the old heading.
        assert!((r.z + 0.6).abs() < 0.02, "{r:?}");
    }

    #[test]
    fn the_heading_follows_the_stick_no_faster_than_its_limit() {
        let mut a = AttitudeLoop::new(&Params::default());
        let mut yaw = 0.0f32;
        for _ in 0..4000 {
            let r = a.step(
                Quat::from_euler(0.0, 0.0, yaw),
                AttitudeSetpoint {
                    yaw_rate: 3.0,
                    ..Default::default()
                },
                1e-3,
            );
            yaw += r.z * 1e-3;
            assert!(r.z <= 1.01);
        }
        assert!((1.5..2.2).contains(&yaw), "{yaw}");
    }

    proptest! {
        #[test]
        fn the_loop_turns_towards_the_setpoint(r in -1.0f32..1.0, p in -0.8f32..0.8, y in -3.0f32..3.0, r0 in -0.8f32..0.8) {
            let q = Quat::from_euler(r0, 0.1, y);
            let rate = settled(q, AttitudeSetpoint { roll: r, pitch: p, yaw_rate: 0.0 });
            let step = Quat { w: 1.0, x: 0.01 * rate.x, y: 0.01 * rate.y, z: 0.01 * rate.z }.normalised();
            let goal = Quat::from_euler(r, p, y).down_in_body();
            let before = (q.down_in_body() - goal).norm();
            let after = ((q * step).down_in_body() - goal).norm();
            prop_assert!(after <= before + 2e-3);
        }
    }
}
