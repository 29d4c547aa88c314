//! Attitude control, 1 kHz: a P loop on the shortest turn to the wanted tilt, a leashed heading for yaw.
//!
//! The tilt target is the direction of down in body axes: a yaw error cannot turn roll into pitch. The heading is never
//! computed; its changes move the leash.
//!
//! A setpoint becomes a direction at the sticks' rate, to save each step a sine. One that is not finite keeps the tilt
//! target and stops the turn in yaw.

use super::gains::Gains;
use crate::maths::filter::LowPass;
use crate::maths::scalar;
use crate::maths::vector::{Quat, Vec3};
use crate::params::Params;

/// Largest lead of the heading setpoint over the heading, rad.
const HEADING_LEASH: f32 = 0.5;
/// Largest roll or pitch setpoint, rad.
const ANGLE_MAX: f32 = 0.5 * scalar::PI;
/// Time constant of the yaw rate setpoint, s: the arms' torsion needs smooth commands.
const YAW_RATE_TAU: f32 = 0.3;
const LEVEL: Vec3 = Vec3::new(0.0, 0.0, 1.0);

/// Attitude setpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AttitudeSetpoint {
    /// Roll, rad, right side down positive; limited to ±π/2.
    pub roll: f32,
    /// Pitch, rad, nose up positive; limited to ±π/2.
    pub pitch: f32,
    /// Yaw rate, rad/s, clockwise from above positive; limited to ±`yaw_slew`.
    pub yaw_rate: f32,
}

/// Prefiltered target of the attitude loop.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Target {
    /// Wanted down in body axes; shorter than 1 while it changes.
    pub down: Vec3,
    /// Wanted less present heading, rad, ±0.5.
    pub ahead: f32,
}

/// Second-order low pass of a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Smooth {
    first: Vec3,
    second: Vec3,
}

impl Smooth {
    const fn at(direction: Vec3) -> Self {
        Self {
            first: direction,
            second: direction,
        }
    }

    #[inline(always)]
    fn blend(&mut self, wanted: Vec3, gain: f32) -> Vec3 {
        self.first = self.first + (wanted - self.first) * gain;
        self.second = self.second + (self.first - self.second) * gain;
        self.second
    }
}

/// The attitude loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeLoop {
    p: f32,
    yaw_p: f32,
    /// Cut-off of the setpoint's prefilter, rad/s.
    cutoff: f32,
    rate_max: f32,
    yaw_rate_max: f32,
    /// Wanted down in body axes, before the prefilter.
    wanted: Vec3,
    wanted_yaw_rate: f32,
    down: Smooth,
    yaw_rate: LowPass,
    heading: Heading,
    ahead: f32,
}

impl AttitudeLoop {
    /// A loop that holds level.
    pub fn new(p: &Params) -> Self {
        let gains = Gains::of(p);
        Self {
            p: gains.attitude_p,
            yaw_p: p.attitude_yaw_p,
            cutoff: gains.setpoint_cutoff,
            rate_max: p.rate_max,
            yaw_rate_max: p.yaw_slew,
            wanted: LEVEL,
            wanted_yaw_rate: 0.0,
            down: Smooth::at(LEVEL),
            yaw_rate: LowPass::default(),
            heading: Heading::of(Quat::IDENTITY),
            ahead: 0.0,
        }
    }

    /// Takes other gains.
    pub fn change(&mut self, gains: &Gains) {
        (self.p, self.cutoff) = (gains.attitude_p, gains.setpoint_cutoff);
    }

    /// Bumpless restart: the target is `q` (unit, body to world) until the next setpoint.
    pub fn reset(&mut self, q: Quat) {
        let down = q.down_in_body();
        self.wanted = down;
        self.down = Smooth::at(down);
        self.wanted_yaw_rate = 0.0;
        self.capture_heading(q);
    }

    /// Sets the target.
    pub fn aim(&mut self, setpoint: AttitudeSetpoint) {
        let AttitudeSetpoint {
            roll,
            pitch,
            yaw_rate,
        } = setpoint;
        if !(roll + pitch + yaw_rate).is_finite() {
            self.wanted_yaw_rate = 0.0;
            return;
        }
        let (sin_roll, cos_roll) = scalar::sin_cos_quarter(scalar::clamp_abs(roll, ANGLE_MAX));
        let (sin_pitch, cos_pitch) = scalar::sin_cos_quarter(scalar::clamp_abs(pitch, ANGLE_MAX));
        self.wanted = Vec3::new(-sin_pitch, cos_pitch * sin_roll, cos_pitch * cos_roll);
        self.wanted_yaw_rate = scalar::clamp_abs(yaw_rate, self.yaw_rate_max);
    }

    /// Takes the heading of `q` (unit, body to world) as the wanted one while yaw is given up.
    #[inline]
    pub fn capture_heading(&mut self, q: Quat) {
        self.heading = Heading::of(q);
        self.ahead = 0.0;
        self.yaw_rate = LowPass::at(0.0);
    }

    /// Body rates (rad/s; roll and pitch within ±`rate_max`, yaw within twice `yaw_slew`) from the attitude `q` (unit,
    /// body to world) to the target, in a step of `dt` s, > 0.
    #[inline(always)]
    pub fn step(&mut self, q: Quat, dt: f32) -> Vec3 {
        // Shortest turn to the wanted tilt, in body axes: twice the sine of half its angle, about its axis.
        let aim = self.down.blend(self.wanted, LowPass::gain(self.cutoff, dt));
        let down = q.down_in_body();
        let gain = self.p * per_sine(aim.dot(down));

        let smoothing = LowPass::gain(1.0 / YAW_RATE_TAU, dt);
        let yaw_rate = self.yaw_rate.blend(self.wanted_yaw_rate, smoothing);
        let now = Heading::of(q);
        let ahead = self.ahead + yaw_rate * dt - now.turned_since(self.heading);
        self.ahead = scalar::clamp_abs(ahead, HEADING_LEASH);
        self.heading = now;
        let yaw = scalar::clamp_abs(yaw_rate + self.yaw_p * self.ahead, 2.0 * self.yaw_rate_max);

        // A heading rate turns about the world's vertical.
        let vertical = down * yaw;
        Vec3::new(
            scalar::clamp_abs(
                gain * (aim.y * down.z - aim.z * down.y) + vertical.x,
                self.rate_max,
            ),
            scalar::clamp_abs(
                gain * (aim.z * down.x - aim.x * down.z) + vertical.y,
                self.rate_max,
            ),
            vertical.z,
        )
    }

    /// Prefiltered target.
    #[inline]
    pub const fn target(&self) -> Target {
        Target {
            down: self.down.second,
            ahead: self.ahead,
        }
    }
}

/// 2 sin(θ/2) / sin θ from cos θ, within 0.6 % up to 90°, where the rate limit acts, and too small beyond; 0 at exactly
/// 180°, where no turn is shortest.
#[inline(always)]
fn per_sine(cosine: f32) -> f32 {
    let e = 1.0 - cosine;
    1.0 + e * (0.22 + 0.186 * e)
}

/// Cosine and sine of the heading times the cosine of the pitch.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Heading {
    north: f32,
    east: f32,
}

impl Heading {
    #[inline]
    fn of(q: Quat) -> Self {
        Self {
            north: 1.0 - 2.0 * (q.y * q.y + q.z * q.z),
            east: 2.0 * (q.w * q.z + q.x * q.y),
        }
    }

    /// Angle turned since `last`, rad, by its tangent (1e-6 rad off at the fastest turn); 0 with a vertical nose, which
    /// has no heading.
    #[inline]
    fn turned_since(self, last: Self) -> f32 {
        let along = last.north * self.north + last.east * self.east;
        let turned = (last.north * self.east - last.east * self.north) / along;
        if along > 1e-6 { turned } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn settled(q: Quat, setpoint: AttitudeSetpoint) -> Vec3 {
        let mut a = AttitudeLoop::new(&Params::default());
        a.reset(q);
        a.aim(setpoint);
        let mut rate = Vec3::ZERO;
        for _ in 0..2000 {
            rate = a.step(q, 1e-3);
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
    fn the_gain_of_a_turn_keeps_its_error_over_the_whole_range() {
        for tenth in 1..1799 {
            let angle = f64::to_radians(0.1 * f64::from(tenth));
            let exact = 1.0 / f64::cos(0.5 * angle);
            let error = f64::from(per_sine(f64::cos(angle) as f32)) / exact - 1.0;
            assert!(tenth > 900 || error.abs() < 6e-3, "{tenth}: {error}");
            // Beyond 90°: enough for the rate limit up to 150°.
            let rate = f64::from(per_sine(f64::cos(angle) as f32)) * angle.sin() * 4.5;
            assert!(!(480..1500).contains(&tenth) || rate > 3.5, "{tenth}: {rate}");
        }
    }

    #[test]
    fn the_change_of_heading_adds_up_to_the_heading() {
        // Flat spin: ten turns at 6 rad/s in steps of 1 ms.
        let turned = |i: i32| Quat::from_euler(0.2, -0.3, 0.0) * spin(0.006 * i as f32);
        let mut sum = 0.0f64;
        for i in 0..10_472 {
            let step = Heading::of(turned(i + 1)).turned_since(Heading::of(turned(i)));
            sum += f64::from(step);
        }
        let start = Heading::of(turned(0));
        let end = Heading::of(turned(10_472));
        let between = f64::from(end.turned_since(start));
        let whole = (sum / core::f64::consts::TAU).round() * core::f64::consts::TAU;
        assert!((sum - whole - between.atan()).abs() < 2e-3, "{sum} {between}");
    }

    fn spin(angle: f32) -> Quat {
        let half = 0.5 * f64::from(angle);
        Quat {
            w: half.cos() as f32,
            x: 0.0,
            y: 0.0,
            z: half.sin() as f32,
        }
    }

    #[test]
    fn a_yaw_error_does_not_leak_into_pitch() {
        let mut a = AttitudeLoop::new(&Params::default());
        a.reset(Quat::IDENTITY);
        let turned = Quat::from_euler(0.0, 0.0, 0.6);
        let r = a.step(turned, 1e-3);
        assert!(r.x.abs() < 0.01 && r.y.abs() < 0.01);
        // 0.5 rad of leash at 1.2 1/s, towards the old heading.
        assert!((r.z + 0.6).abs() < 0.02, "{r:?}");
    }

    #[test]
    fn the_heading_follows_the_stick_no_faster_than_its_limit() {
        let mut a = AttitudeLoop::new(&Params::default());
        let mut yaw = 0.0f32;
        a.aim(AttitudeSetpoint {
            yaw_rate: 3.0,
            ..Default::default()
        });
        for _ in 0..4000 {
            let r = a.step(Quat::from_euler(0.0, 0.0, yaw), 1e-3);
            yaw += r.z * 1e-3;
            assert!(r.z <= 1.01);
        }
        assert!((1.5..2.2).contains(&yaw), "{yaw}");
    }

    #[test]
    fn both_quaternions_of_an_attitude_turn_the_same_short_way() {
        for (roll, pitch) in [(0.3, 0.0), (-0.2, 0.25), (0.0, -0.4)] {
            let q = Quat::from_euler(0.1, -0.1, 1.0);
            let twin = Quat {
                w: -q.w,
                x: -q.x,
                y: -q.y,
                z: -q.z,
            };
            let setpoint = AttitudeSetpoint {
                roll,
                pitch,
                yaw_rate: 0.0,
            };
            let (a, b) = (settled(q, setpoint), settled(twin, setpoint));
            assert!(a.norm() > 0.5 && (a - b).norm() < 0.02, "{a:?} {b:?}");
        }
    }

    #[test]
    fn a_heading_rate_turns_about_the_vertical_of_the_world() {
        for (roll, pitch) in [(0.5, 0.0), (-0.4, 0.0), (0.0, 0.5), (0.4, -0.3)] {
            let q = Quat::from_euler(roll, pitch, 0.7);
            let setpoint = AttitudeSetpoint {
                roll,
                pitch,
                yaw_rate: 0.4,
            };
            let r = settled(q, setpoint);
            // World axes, about down: 0.4 rad/s plus the leash's 1.2 1/s · 0.5 rad.
            let turn = q.rotate(r);
            assert!(
                turn.x.abs() < 0.03 && turn.y.abs() < 0.03 && (turn.z - 1.0).abs() < 0.03,
                "{roll} {pitch}: {turn:?}"
            );
        }
    }

    #[test]
    fn a_setpoint_that_is_no_number_holds_the_tilt_and_ends_the_turn() {
        let mut a = AttitudeLoop::new(&Params::default());
        let good = AttitudeSetpoint {
            roll: 0.2,
            pitch: -0.1,
            yaw_rate: 0.4,
        };
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            a.aim(good);
            for _ in 0..2000 {
                a.step(Quat::IDENTITY, 1e-3);
            }
            let none = AttitudeSetpoint {
                roll: bad,
                pitch: bad,
                yaw_rate: bad,
            };
            a.aim(none);
            for _ in 0..3000 {
                a.step(Quat::IDENTITY, 1e-3);
            }
            let Vec3 { x, y, z } = a.target().down;
            let (roll, pitch) = (f32::atan2(y, z), -f32::asin(x));
            assert!((roll - 0.2).abs() < 1e-3 && (pitch + 0.1).abs() < 1e-3);
            assert!(a.yaw_rate.value().abs() < 1e-3, "{bad}: {}", a.yaw_rate.value());
        }
    }

    proptest! {
        #[test]
        fn no_nan_comes_out_and_the_loop_recovers(
            bits in prop::collection::vec(any::<[u32; 3]>(), 1..40),
            q in prop::collection::vec(prop::array::uniform4(-1.0f32..1.0), 40),
        ) {
            let p = Params::default();
            let mut a = AttitudeLoop::new(&p);
            let mut q_now = Quat::IDENTITY;
            for ([roll, pitch, yaw_rate], [w, x, y, z]) in bits.into_iter().zip(q) {
                q_now = Quat { w, x, y, z }.normalised();
                let f = f32::from_bits;
                let setpoint = AttitudeSetpoint { roll: f(roll), pitch: f(pitch), yaw_rate: f(yaw_rate) };
                a.aim(setpoint);
                let r = a.step(q_now, 1e-3);
                let Target { down, ahead } = a.target();
                let finite = |v: Vec3| v.to_array().iter().all(|x| x.is_finite());
                prop_assert!(finite(r) && finite(down) && ahead.is_finite(), "{setpoint:?} {r:?}");
                prop_assert!(r.x.abs() <= p.rate_max && r.y.abs() <= p.rate_max, "{r:?}");
                prop_assert!(r.z.abs() <= 2.01 * p.yaw_slew, "{r:?}");
            }
            // A vehicle that follows its commands returns to level rest.
            const DT: f32 = 4e-3;
            let mut r = Vec3::ZERO;
            a.aim(AttitudeSetpoint::default());
            for _ in 0..2500 {
                r = a.step(q_now, DT);
                prop_assert!(r.to_array().iter().all(|x| x.is_finite()));
                let turn = r * (0.5 * DT);
                q_now = (q_now * Quat { w: 1.0, x: turn.x, y: turn.y, z: turn.z }).normalised();
            }
            prop_assert!(q_now.down_in_body().z > 0.999 && r.norm() < 0.05, "{q_now:?} {r:?}");
        }

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
