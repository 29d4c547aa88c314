//! Reel, tendon and servo of one arm: conversion between angle, force and pulse.

use super::ForceLimit;
use crate::allocation::wrench::PerArm;
use crate::gripper::RESPONSE_RANGE;
use crate::maths::scalar;
use crate::params::Params;
use crate::pilot::actuator_test;

/// Bounds of a servo's release and full pulse, µs: the usual 500 to 2500 with room for a trim.
const PULSE_MIN_US: f32 = 550.0;
const PULSE_MAX_US: f32 = 2450.0;
/// Least distance of full and release pulse, µs: a servo's travel is longer.
pub const SPAN_MIN_US: f32 = 200.0;
/// Tilt at which a released servo's tendon is just taut, rad: 23°, beyond flight, so that a flying arm never pulls it
/// (built so; assumed).
pub const REFERENCE_TILT: f32 = 0.4;
const TRIM_MAX_US: f32 = 50.0;
/// Used share of the servo's speed, so that it follows its command.
const SPEED_SHARE: f32 = 0.9;
/// Age of the tilt when the servo's task reads it, s: sensor 20 ms, half of the arms' 10 ms period.
const TILT_AGE: f32 = 0.025;

/// Reel, tendon and servo of one arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reel {
    /// Radius of the reel, m.
    radius: f32,
    /// Lever of the tendon about the arm's hinge, m.
    lever: f32,
    /// Tendon stiffness, N/m.
    stiffness: f32,
    /// Stall torque, N·m.
    stall: f32,
    /// No-load speed, rad/s.
    slew: f32,
    /// Servo travel, rad.
    range: f32,
    /// Release pulse with trim, µs.
    release_us: f32,
    /// From release to full pulse, µs; negative if mirrored.
    span_us: f32,
    /// Age of the tilt when the pulse acts, s.
    pub(super) tilt_age: f32,
    pub(super) limit: ForceLimit,
}

impl Reel {
    /// The parts of arm `servo` (0..=3). A full pulse closer to the release pulse than [`SPAN_MIN_US`] is moved to that
    /// distance, on the side with room.
    pub fn from_params(p: &Params, servo: usize) -> Self {
        let [trim, release, full, slew] = match servo {
            0 => [p.servo_trim_1, p.servo_release_1, p.servo_full_1, p.servo_slew_1],
            1 => [p.servo_trim_2, p.servo_release_2, p.servo_full_2, p.servo_slew_2],
            2 => [p.servo_trim_3, p.servo_release_3, p.servo_full_3, p.servo_slew_3],
            _ => [p.servo_trim_4, p.servo_release_4, p.servo_full_4, p.servo_slew_4],
        };
        let release = scalar::clamp(release, PULSE_MIN_US, PULSE_MAX_US);
        let full = enforce_min_span(release, scalar::clamp(full, PULSE_MIN_US, PULSE_MAX_US));
        Self {
            radius: p.reel_radius,
            lever: p.tendon_lever,
            stiffness: p.tendon_stiffness,
            stall: p.servo_stall,
            slew,
            range: p.servo_range,
            release_us: release + scalar::clamp(trim, -TRIM_MAX_US, TRIM_MAX_US),
            span_us: full - release,
            // Half a frame until the task runs, half until the servo has moved.
            tilt_age: TILT_AGE + 1.0 / p.servo_frame_rate,
            limit: ForceLimit::from_params(p),
        }
    }

    /// The same parts with a tendon of the `share` of its stiffness, as a closing arm shows it.
    #[must_use]
    pub fn softened(mut self, share: f32) -> Self {
        self.stiffness *= scalar::clamp(share, RESPONSE_RANGE.0, 1.0);
        self
    }

    /// The parts of all four arms.
    pub fn all(p: &Params) -> PerArm<Self> {
        [0, 1, 2, 3].map(|servo| Self::from_params(p, servo))
    }

    /// Servo angle (rad from release) for `force` (N) at `tilt` (rad), within its travel.
    pub fn angle(&self, force: f32, tilt: f32) -> f32 {
        let take_up = self.lever * (REFERENCE_TILT - tilt) + force / self.stiffness;
        scalar::clamp(take_up / self.radius, 0.0, self.range)
    }

    /// Tendon force (N, >= 0) with the servo at `angle` and the arm at `tilt` (rad).
    pub fn force(&self, angle: f32, tilt: f32) -> f32 {
        let stretch = self.radius * angle - self.lever * (REFERENCE_TILT - tilt);
        scalar::clamp(self.stiffness * stretch, 0.0, f32::MAX)
    }

    /// Pulse width (µs, with trim) for the servo at `angle` (rad from release).
    pub fn pulse(&self, angle: f32) -> f32 {
        self.release_us + self.span_us * scalar::clamp(angle / self.range, 0.0, 1.0)
    }

    /// Like [`Self::pulse`] up to the limits of servos, for finding the travel in actuator tests.
    pub fn pulse_beyond(&self, angle: f32) -> f32 {
        let pulse = self.release_us + self.span_us * (angle / self.range);
        scalar::clamp(pulse, actuator_test::PULSE_MIN_US, actuator_test::PULSE_MAX_US)
    }

    /// Servo angle (rad from release) for a pulse (µs).
    pub fn angle_of(&self, pulse_us: f32) -> f32 {
        (pulse_us - self.release_us) / self.span_us * self.range
    }

    /// Servo speed (rad/s) against the force `force` (N).
    pub(super) fn speed(&self, force: f32) -> f32 {
        let load = scalar::clamp(force * self.radius / self.stall, 0.0, 1.0);
        SPEED_SHARE * self.slew * (1.0 - load)
    }
}

fn enforce_min_span(release: f32, full: f32) -> f32 {
    let span = full - release;
    if span.abs() >= SPAN_MIN_US {
        return full;
    }
    let room_above = PULSE_MAX_US - release;
    let room_below = release - PULSE_MIN_US;
    let above = if span > 0.0 {
        room_above >= SPAN_MIN_US
    } else if span < 0.0 {
        room_below < SPAN_MIN_US
    } else {
        room_above >= room_below
    };
    release + if above { SPAN_MIN_US } else { -SPAN_MIN_US }
}
