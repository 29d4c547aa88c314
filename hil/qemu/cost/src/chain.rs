//! The flight step's stages, its laws, and the whole: functions that are not inlined, with inputs and outputs in
//! memory. The stages are those of [`FlightChain`]; laws run on their own copies.

use core::hint::black_box;

use sophie_chain::{FlightChain, Flow};
use sophie_control::allocation::mixer::{Allocation, Conditions, Flexible, Mix};
use sophie_control::allocation::thrust_curve::ThrustCurve;
use sophie_control::allocation::wrench::{Configuration, PerArm};
use sophie_control::attitude::attitude_loop::{AttitudeLoop, Target};
use sophie_control::attitude::imu_filter::AxisFilter;
use sophie_control::attitude::rate_loop::RateLoop;
use sophie_control::chain::Demand;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;

use crate::inputs::Inputs;

/// At rest, with parameters unknown to the compiler.
pub fn at_rest() -> FlightChain {
    let p = black_box(Params::default());
    let allocation = Flexible::new(black_box(Configuration::B), &p);
    FlightChain::new(&p, black_box(4000.0), allocation)
}

#[inline(never)]
pub fn nothing(_: &mut (), _: &u32) {}

/// Stage 1: a batch through the gyro filter.
#[inline(never)]
pub fn filter(c: &mut FlightChain, i: &Inputs) {
    c.sense(i.at_us, &i.batch);
}

/// Stage 2: attitude and rate from the filtered sample.
#[inline(never)]
pub fn estimator(c: &mut FlightChain, _: &Inputs) {
    c.estimate();
}

/// Stage 3: demand, with loop switching and resting limits.
#[inline(never)]
pub fn control(c: &mut FlightChain, i: &Inputs) {
    c.control(&i.command);
}

/// Stage 4: commands from demand and arm readings.
#[inline(never)]
pub fn mixing(c: &mut FlightChain, i: &Inputs) {
    c.mix(&i.surroundings);
}

/// The whole step in one call.
#[inline(never)]
pub fn whole(c: &mut FlightChain, i: &Inputs) {
    c.step(i.at_us, &i.batch, &i.command, &i.surroundings);
}

/// The chain's laws, with inputs and outputs.
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

/// Direction from the sticks, 100 Hz.
#[inline(never)]
pub fn aim(l: &mut Laws, i: &Inputs) {
    l.attitude.aim(i.sticks);
}

/// Rates, and the logged target. With yaw given up, the heading follows.
#[inline(never)]
pub fn attitude(l: &mut Laws, _: &Inputs) {
    let a = &l.flow.attitude;
    if l.flow.mix.yaw_gated {
        l.attitude.capture_heading(a.q);
    }
    l.wanted = l.attitude.step(a.q, a.dt);
    l.target = l.attitude.target();
}

#[inline(never)]
pub fn rate(l: &mut Laws, i: &Inputs) {
    let (a, feedback) = (&l.flow.attitude, l.flow.mix.feedback());
    l.moment = l.rate.step(l.wanted, a.rate, feedback, !i.resting, a.dt);
}

/// Thrusts from a wrench: Jacobian, allocation, desaturation.
#[inline(never)]
pub fn allocation(l: &mut Laws, i: &Inputs) {
    if let Demand::Wrench(wrench) | Demand::Resting(wrench) = l.flow.demand {
        let conditions = Conditions {
            yaw: !i.resting,
            thrust_ratio: i.battery_ratio,
            dt: l.flow.attitude.dt,
        };
        l.mix = l.allocation.allocate(&wrench, conditions);
    }
}

/// Tilt and slope of the arms from the sent thrusts.
#[inline(never)]
pub fn tilt(l: &mut Laws, _: &Inputs) {
    l.allocation.follow(&l.mix.thrusts, l.flow.attitude.dt);
}

#[inline(never)]
pub fn commands(l: &mut Laws, i: &Inputs) {
    l.commands = l.curve.commands(&l.mix.thrusts, i.battery_ratio);
}

/// Tilt correction by one arm's sensor, 100 Hz each.
#[inline(never)]
pub fn arm_sensor(l: &mut Laws, i: &Inputs) {
    if let Some((arm, measured)) = i.arm {
        l.allocation.tilt_mut().correct(arm, measured);
    }
}
