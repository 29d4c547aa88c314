//! The control path from raw readings to motor commands, stage by stage and at one go.
//!
//! Each stage is a function that is not inlined, with its inputs and outputs in memory: what a call from a task costs.

use core::hint::black_box;

use sophie_control::attitude::{AttitudeLoop, Target};
use sophie_control::estimator::Estimator;
use sophie_control::imu_filter::{AxisFilter, ImuFilter};
use sophie_control::mixer::{Allocation, Conditions, Flexible, Mix};
use sophie_control::params::Params;
use sophie_control::rate::{Feedback, RateLoop};
use sophie_control::thrust_curve::ThrustCurve;
use sophie_control::vector::{Quat, Vec3};
use sophie_control::wrench::{Configuration, PerArm, Wrench};

use crate::inputs::{Inputs, Reading};

/// The laws' states and what they hand on.
#[derive(Clone)]
pub struct Chain {
    pub axes: AxisFilter,
    pub filter: ImuFilter,
    pub estimator: Estimator,
    pub attitude: AttitudeLoop,
    pub rate: RateLoop,
    pub mixer: Flexible,
    pub curve: ThrustCurve,
    pub flow: Flow,
}

/// What one stage hands to the next.
#[derive(Clone, Copy)]
pub struct Flow {
    pub accel_bias: Vec3,
    pub sample: Reading,
    pub axes: Vec3,
    pub body_rate: Vec3,
    pub q: Quat,
    pub wanted: Vec3,
    pub target: Target,
    pub moment: Vec3,
    pub mix: Mix,
    pub commands: PerArm<f32>,
}

impl Chain {
    /// At rest, with parameters of which the compiler knows nothing.
    pub fn new() -> Self {
        let p = black_box(Params::default());
        let raw_rate = black_box(4000.0);
        Self {
            axes: AxisFilter::low_pass(p.gyro_cutoff, raw_rate),
            filter: ImuFilter::new(p.gyro_cutoff, raw_rate),
            estimator: Estimator::new(&p),
            attitude: AttitudeLoop::new(&p),
            rate: RateLoop::new(&p, black_box(1000.0)),
            mixer: Flexible::new(black_box(Configuration::B), &p),
            curve: ThrustCurve::from_params(&p),
            flow: Flow {
                accel_bias: Vec3::new(p.accel_bias_x, p.accel_bias_y, p.accel_bias_z),
                sample: (Vec3::ZERO, Vec3::ZERO),
                axes: Vec3::ZERO,
                body_rate: Vec3::ZERO,
                q: Quat::IDENTITY,
                wanted: Vec3::ZERO,
                target: Target::default(),
                moment: Vec3::ZERO,
                mix: Mix {
                    yaw_gated: true,
                    ..Mix::default()
                },
                commands: [0.0; 4],
            },
        }
    }
}

/// What the mixer gave, as the rate loop wants to know it.
#[inline(always)]
fn feedback(mix: &Mix) -> Feedback {
    Feedback {
        roll_pitch: mix.given.roll_pitch,
        yaw: mix.given.yaw,
        yaw_gated: mix.yaw_gated,
    }
}

/// Nothing but the call.
#[inline(never)]
pub fn nothing(_: &mut (), _: &u32) {}

/// Three axes through one biquad each.
#[inline(never)]
pub fn axes(c: &mut Chain, i: &Inputs) {
    let [(gyro, _), ..] = &i.batch;
    c.flow.axes = c.axes.step(*gyro);
}

/// One batch through the filter of the inertial sensor.
#[inline(never)]
pub fn filter(c: &mut Chain, i: &Inputs) {
    let bias = c.flow.accel_bias;
    let filtered = c
        .filter
        .batch(i.batch.iter().map(|(gyro, accel)| (*gyro, *accel - bias)));
    c.flow.sample = filtered.newest.unwrap_or(c.flow.sample);
}

/// Attitude and rate from the filtered sample.
#[inline(never)]
pub fn estimator(c: &mut Chain, i: &Inputs) {
    let (gyro, accel) = c.flow.sample;
    c.flow.body_rate = c.estimator.step(gyro, accel, i.dt);
    c.flow.q = c.estimator.attitude();
}

/// What the sticks want, at 100 Hz.
#[inline(never)]
pub fn aim(c: &mut Chain, i: &Inputs) {
    if let Some(setpoint) = i.setpoint {
        c.attitude.aim(setpoint);
    }
}

/// Wanted rates from the attitude, and the target that is logged. A yaw that was given up takes the heading along.
#[inline(never)]
pub fn attitude(c: &mut Chain, i: &Inputs) {
    if c.flow.mix.yaw_gated {
        c.attitude.capture_heading(c.flow.q);
    }
    c.flow.wanted = c.attitude.step(c.flow.q, i.dt);
    c.flow.target = c.attitude.target();
}

/// Moments from the rates.
#[inline(never)]
pub fn rate(c: &mut Chain, i: &Inputs) {
    let f = &mut c.flow;
    f.moment = c
        .rate
        .step(f.wanted, f.body_rate, feedback(&f.mix), i.integrate, i.dt);
}

/// Thrusts from moments: Jacobian from the tilt, allocation, desaturation.
#[inline(never)]
pub fn allocation(c: &mut Chain, i: &Inputs) {
    let f = &mut c.flow;
    let wrench = Wrench {
        thrust: i.thrust,
        roll: f.moment.x,
        pitch: f.moment.y,
        yaw: f.moment.z,
    };
    let conditions = Conditions {
        yaw: i.yaw,
        battery_ratio: i.battery_ratio,
        dt: i.dt,
    };
    f.mix = c.mixer.allocate(wrench, conditions);
}

/// Tilt and slope of the four arms from the thrusts sent.
#[inline(never)]
pub fn tilt(c: &mut Chain, i: &Inputs) {
    c.mixer.follow(&c.flow.mix.thrusts, i.dt);
}

/// What the sensor of one arm teaches of its tilt, each at 100 Hz.
#[inline(never)]
pub fn arm_sensor(c: &mut Chain, i: &Inputs) {
    teach(&mut c.mixer, i);
}

#[inline(always)]
fn teach(mixer: &mut Flexible, i: &Inputs) {
    if let Some((arm, measured)) = i.arm {
        mixer.tilt_mut().correct(arm, measured);
    }
}

/// Motor commands from thrusts and battery.
#[inline(never)]
pub fn commands(c: &mut Chain, i: &Inputs) {
    c.flow.commands = c.curve.commands(&c.flow.mix.thrusts, i.battery_ratio);
}

/// All of it at one go, as one call.
#[inline(never)]
pub fn whole(c: &mut Chain, i: &Inputs) {
    let bias = c.flow.accel_bias;
    let filtered = c
        .filter
        .batch(i.batch.iter().map(|(gyro, accel)| (*gyro, *accel - bias)));
    c.flow.sample = filtered.newest.unwrap_or(c.flow.sample);
    let (gyro, accel) = c.flow.sample;
    let f = &mut c.flow;
    f.body_rate = c.estimator.step(gyro, accel, i.dt);
    f.q = c.estimator.attitude();
    if f.mix.yaw_gated {
        c.attitude.capture_heading(f.q);
    }
    if let Some(setpoint) = i.setpoint {
        c.attitude.aim(setpoint);
    }
    f.wanted = c.attitude.step(f.q, i.dt);
    f.target = c.attitude.target();
    f.moment = c
        .rate
        .step(f.wanted, f.body_rate, feedback(&f.mix), i.integrate, i.dt);
    let wrench = Wrench {
        thrust: i.thrust,
        roll: f.moment.x,
        pitch: f.moment.y,
        yaw: f.moment.z,
    };
    let conditions = Conditions {
        yaw: i.yaw,
        battery_ratio: i.battery_ratio,
        dt: i.dt,
    };
    f.mix = c.mixer.mix(wrench, conditions);
    f.commands = c.curve.commands(&f.mix.thrusts, i.battery_ratio);
    teach(&mut c.mixer, i);
}
