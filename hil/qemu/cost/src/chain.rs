//! The flight step from raw readings to motor commands: its stages, its laws one by one, and all of it at one go.
//!
//! Each is a function that is not inlined, with its inputs and outputs in memory: what a call from a task costs. The stages
//! are those of [`FlightChain`], called in its order; a law is run on a copy of its own, so that nothing is composed here.

use core::hint::black_box;

use sophie_control::attitude::{AttitudeLoop, Target};
use sophie_control::chain::{Demand, FlightChain, Flow};
use sophie_control::imu_filter::AxisFilter;
use sophie_control::mixer::{Allocation, Conditions, Flexible, Mix};
use sophie_control::params::Params;
use sophie_control::rate::RateLoop;
use sophie_control::thrust_curve::ThrustCurve;
use sophie_control::vector::Vec3;
use sophie_control::wrench::{Configuration, PerArm};

use crate::inputs::Inputs;

/// At rest, with parameters of which the compiler knows nothing.
pub fn at_rest() -> FlightChain {
    let p = black_box(Params::default());
    let allocation = Flexible::new(black_box(Configuration::B), &p);
    FlightChain::new(&p, black_box(4000.0), allocation)
}

/// Nothing but the call.
#[inline(never)]
pub fn nothing(_: &mut (), _: &u32) {}

/// First stage: one batch through the filter of the inertial sensor.
#[inline(never)]
pub fn filter(c: &mut FlightChain, i: &Inputs) {
    c.sense(i.at_us, &i.batch);
}

/// Second stage: attitude and rate from the filtered sample.
#[inline(never)]
pub fn estimator(c: &mut FlightChain, _: &Inputs) {
    c.estimate();
}

/// Third stage: the demand, with loop switching and resting limits.
#[inline(never)]
pub fn control(c: &mut FlightChain, i: &Inputs) {
    c.control(&i.command);
}

/// Fourth stage: commands from the demand, with the arms' readings.
#[inline(never)]
pub fn mixing(c: &mut FlightChain, i: &Inputs) {
    c.mix(&i.surroundings);
}

/// All of it at one go, as one call.
#[inline(never)]
pub fn whole(c: &mut FlightChain, i: &Inputs) {
    c.step(i.at_us, &i.batch, &i.command, &i.surroundings);
}

/// The laws of the chain on copies of their own, and what they are given and give.
pub struct Laws {
    flow: Flow,
    axes: AxisFilter,
    attitude: AttitudeLoop,
    rate: RateLoop,
    allocation: Flexible,
    curve: ThrustCurve,
    smooth: Vec3,
    wanted: Vec3,
    target: Target,
    moment: Vec3,
    mix: Mix,
    commands: PerArm<f32>,
}

impl Laws {
    /// At rest.
    pub fn new(chain: &FlightChain) -> Self {
        let p = black_box(Params::default());
        Self {
            flow: chain.flow,
            axes: AxisFilter::low_pass(p.gyro_cutoff, black_box(4000.0)),
            attitude: chain.control.attitude,
            rate: chain.control.rate,
            allocation: chain.mixing.allocation,
            curve: chain.mixing.curve,
            smooth: Vec3::ZERO,
            wanted: Vec3::ZERO,
            target: Target::default(),
            moment: Vec3::ZERO,
            mix: Mix::default(),
            commands: [0.0; 4],
        }
    }

    /// Takes over where `chain` stands.
    pub fn take(&mut self, chain: &FlightChain) {
        self.flow = chain.flow;
        self.attitude = chain.control.attitude;
        self.rate = chain.control.rate;
        self.allocation = chain.mixing.allocation;
    }
}

/// Three axes through one biquad each.
#[inline(never)]
pub fn axes(l: &mut Laws, i: &Inputs) {
    let [first, ..] = &i.batch;
    l.smooth = l.axes.step(first.gyro);
}

/// The direction that the sticks want, at 100 Hz.
#[inline(never)]
pub fn aim(l: &mut Laws, i: &Inputs) {
    l.attitude.aim(i.sticks);
}

/// Wanted rates from the attitude, and the target that is logged. A yaw that was given up takes the heading along.
#[inline(never)]
pub fn attitude(l: &mut Laws, _: &Inputs) {
    let a = &l.flow.attitude;
    if l.flow.mix.yaw_gated {
        l.attitude.capture_heading(a.q);
    }
    l.wanted = l.attitude.step(a.q, a.dt);
    l.target = l.attitude.target();
}

/// Moments from the rates.
#[inline(never)]
pub fn rate(l: &mut Laws, i: &Inputs) {
    let (a, feedback) = (&l.flow.attitude, l.flow.mix.feedback());
    l.moment = l.rate.step(l.wanted, a.rate, feedback, !i.resting, a.dt);
}

/// Thrusts from a wrench: Jacobian from the tilt, allocation, desaturation.
#[inline(never)]
pub fn allocation(l: &mut Laws, i: &Inputs) {
    if let Demand::Wrench(wrench) | Demand::Resting(wrench) = l.flow.demand {
        let conditions = Conditions {
            yaw: !i.resting,
            battery_ratio: i.battery_ratio,
            dt: l.flow.attitude.dt,
        };
        l.mix = l.allocation.allocate(&wrench, conditions);
    }
}

/// Tilt and slope of the four arms from the thrusts sent.
#[inline(never)]
pub fn tilt(l: &mut Laws, _: &Inputs) {
    l.allocation.follow(&l.mix.thrusts, l.flow.attitude.dt);
}

/// Motor commands from thrusts and battery.
#[inline(never)]
pub fn commands(l: &mut Laws, i: &Inputs) {
    l.commands = l.curve.commands(&l.mix.thrusts, i.battery_ratio);
}

/// What the sensor of one arm corrects of its tilt, each at 100 Hz.
#[inline(never)]
pub fn arm_sensor(l: &mut Laws, i: &Inputs) {
    if let Some((arm, measured)) = i.arm {
        l.allocation.tilt_mut().correct(arm, measured);
    }
}
