//! The control laws on inputs that look like flight, folded stage by stage: equal on every machine, bit by bit.

use core::fmt::Arguments;

use sophie_conformance::fold::{Fold, Noise};
use sophie_control::attitude::{AttitudeLoop, AttitudeSetpoint};
use sophie_control::estimator::Estimator;
use sophie_control::imu_filter::ImuFilter;
use sophie_control::math;
use sophie_control::mixer::{Allocation, Conditions};
use sophie_control::params::Params;
use sophie_control::rate::{Feedback, RateLoop};
use sophie_control::thrust_curve::ThrustCurve;
use sophie_control::vector::Vec3;
use sophie_control::wrench::{Configuration, Wrench};
use sophie_mixers::{Mixer, Variant};

/// Inputs of each function of the maths module.
const INPUTS: u32 = 4096;
/// Control steps of each mixer: 3 s of flight, with the calibration at rest before them.
const STEPS: u32 = 3000;
const REST: u32 = 3000;
/// Readings of the inertial sensor in a control step.
const READINGS: u32 = 4;
const DT: f32 = 1e-3;

/// A function of one number.
type Function = fn(f32) -> f32;

/// Prints a line for each group.
pub fn run(print: &mut dyn FnMut(Arguments<'_>)) {
    functions(print);
    for (name, variant) in [
        ("rigid", Variant::Rigid),
        ("paper", Variant::Paper),
        ("frozen", Variant::Frozen),
        ("flexible", Variant::Flexible),
    ] {
        flight(print, name, variant);
    }
}

fn functions(print: &mut dyn FnMut(Arguments<'_>)) {
    let one: [(&str, Function, f32); 6] = [
        ("sin", math::sin, 8.0),
        ("cos", math::cos, 8.0),
        ("asin", math::asin, 1.1),
        ("tan", math::tan, 1.2),
        ("sqrt", math::sqrt, 1e6),
        ("inv_sqrt", math::inv_sqrt, 1e6),
    ];
    for (name, function, range) in one {
        let mut noise = Noise::new(1);
        let mut fold = Fold::new();
        for _ in 0..INPUTS {
            fold.add(function(noise.unit() * range).to_bits());
        }
        print(format_args!("math {name}: {fold}"));
    }
    let mut noise = Noise::new(2);
    let mut fold = Fold::new();
    for _ in 0..INPUTS {
        fold.add(math::atan2(noise.unit(), noise.unit()).to_bits());
    }
    print(format_args!("math atan2: {fold}"));
}

/// Sensor to motor command, open loop: the inputs are noise about a swaying attitude, so every branch is taken.
fn flight(print: &mut dyn FnMut(Arguments<'_>), name: &str, variant: Variant) {
    let params = Params::default();
    let mut noise = Noise::new(3);
    let mut filter = ImuFilter::new(params.gyro_cutoff, 4000.0);
    let mut estimator = Estimator::new(&params);
    let mut attitude = AttitudeLoop::new(&params);
    let mut rate = RateLoop::new(&params, 1000.0);
    let mut mixer = Mixer::new(variant, Configuration::default(), &params);
    let curve = ThrustCurve::from_params(&params);
    let mut feedback = Feedback {
        roll_pitch: 0.0,
        yaw: 0.0,
        yaw_gated: true,
    };
    let [mut filtered, mut estimated, mut asked, mut mixed] = [Fold::new(); 4];
    for step in 0..REST + STEPS {
        let moving = if step < REST { 0.0 } else { 1.0 };
        let mut sample = (Vec3::ZERO, Vec3::ZERO);
        for _ in 0..READINGS {
            let gyro = vector(&mut noise) * (0.01 + 1.5 * moving);
            let accel = Vec3::new(0.0, 0.0, -math::GRAVITY) + vector(&mut noise) * (0.05 + 2.0 * moving);
            sample = filter.step(gyro, accel).unwrap_or(sample);
        }
        let (gyro, accel) = sample;
        add(&mut filtered, gyro);
        add(&mut filtered, accel);
        let body_rate = estimator.step(gyro, accel, DT);
        let q = estimator.attitude();
        for part in [q.w, q.x, q.y, q.z] {
            estimated.add(part.to_bits());
        }
        if step < REST {
            continue;
        }
        let setpoint = AttitudeSetpoint {
            roll: 0.5 * noise.unit(),
            pitch: 0.5 * noise.unit(),
            yaw_rate: 0.5 * noise.unit(),
        };
        attitude.aim(setpoint);
        let wanted = attitude.step(q, DT);
        let torque = rate.step(wanted, body_rate, feedback, true, DT);
        add(&mut asked, torque);
        let wrench = Wrench {
            thrust: 18.0 + 16.0 * noise.unit(),
            roll: torque.x,
            pitch: torque.y,
            yaw: torque.z,
        };
        if step % 10 == 0 {
            for (arm, tilt) in mixer.tilt().tilt().into_iter().enumerate() {
                mixer.tilt_mut().correct(arm, tilt + 0.05 * noise.unit());
            }
        }
        let battery_ratio = 1.0 + 0.15 * noise.unit();
        let mix = mixer.mix(
            wrench,
            Conditions {
                yaw: true,
                battery_ratio,
                dt: DT,
            },
        );
        feedback = Feedback {
            roll_pitch: mix.given.roll_pitch,
            yaw: mix.given.yaw,
            yaw_gated: mix.yaw_gated,
        };
        for thrust in mix.thrusts {
            mixed.add(curve.command(thrust, battery_ratio).to_bits());
        }
    }
    print(format_args!("{name} filter: {filtered}"));
    print(format_args!("{name} estimator: {estimated}"));
    print(format_args!("{name} control: {asked}"));
    print(format_args!("{name} mixer: {mixed}"));
}

fn vector(noise: &mut Noise) -> Vec3 {
    Vec3::new(noise.unit(), noise.unit(), noise.unit())
}

fn add(fold: &mut Fold, v: Vec3) {
    for part in v.to_array() {
        fold.add(part.to_bits());
    }
}
