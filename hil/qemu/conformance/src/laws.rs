//! Control laws on flight-like inputs, hashed by stage: bit-identical on every machine.

use core::fmt::Arguments;

use sophie_chain::FlightChain;
use sophie_conformance::fold::{Fold, Noise};
use sophie_control::allocation::wrench::{Configuration, Wrench};
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{ArmReading, Command, Demand, ImuReading, Surroundings};
use sophie_control::maths::scalar;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;
use sophie_mixers::{Mixer, Variant};

const INPUTS: u32 = 4096;
/// 3 s of flight after calibration.
const STEPS: u32 = 3000;
const REST: u32 = 3000;
const READINGS: usize = 4;
const RATE_HZ: f32 = 4000.0;
const STRETCH: u32 = 250;

type Function = fn(f32) -> f32;

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
        ("sin", scalar::sin, 8.0),
        ("cos", scalar::cos, 8.0),
        ("asin", scalar::asin, 1.1),
        ("tan", scalar::tan, 1.2),
        ("sqrt", scalar::sqrt, 1e6),
        ("inv_sqrt", scalar::inv_sqrt, 1e6),
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
        fold.add(scalar::atan2(noise.unit(), noise.unit()).to_bits());
    }
    print(format_args!("math atan2: {fold}"));
}

/// Open loop: noise around a swaying attitude.
fn flight(print: &mut dyn FnMut(Arguments<'_>), name: &str, variant: Variant) {
    let params = Params::default();
    let mut noise = Noise::new(3);
    let allocation = Mixer::new(variant, Configuration::default(), &params);
    let mut chain = FlightChain::new(&params, RATE_HZ, allocation);
    let [mut filtered, mut estimated, mut asked, mut mixed] = [Fold::new(); 4];
    let mut command = Command::default();
    let mut surroundings = Surroundings::default();
    for step in 0..REST + STEPS {
        let moving = if step < REST { 0.0 } else { 1.0 };
        let at_us = 1000 * u64::from(step);
        let batch: [_; READINGS] = core::array::from_fn(|_| {
            let gyro = vector(&mut noise) * (0.01 + 1.5 * moving);
            let accel = Vec3::new(0.0, 0.0, -scalar::GRAVITY) + vector(&mut noise) * (0.05 + 2.0 * moving);
            ImuReading { gyro, accel }
        });
        if step >= REST {
            command = Command {
                setpoint: setpoint(step / STRETCH, &mut noise),
                at_us,
                gentle: false,
            };
            surroundings.battery_ratio = Some(1.0 + 0.15 * noise.unit());
        }
        if step % 10 == 0 {
            let tilt = chain.flow.mix.tilt.map(|tilt| Some(tilt + 0.05 * noise.unit()));
            surroundings.arms = Some(ArmReading { at_us, tilt });
        }
        chain.step(at_us, &batch, &command, &surroundings);
        let flow = &chain.flow;
        add(&mut filtered, flow.sample.gyro);
        add(&mut filtered, flow.sample.accel);
        let q = flow.attitude.q;
        for part in [q.w, q.x, q.y, q.z] {
            estimated.add(part.to_bits());
        }
        if let Demand::Wrench(w) | Demand::Resting(w) = flow.demand {
            for part in [w.thrust, w.roll, w.pitch, w.yaw] {
                asked.add(part.to_bits());
            }
        }
        for command in flow.mix.commands {
            mixed.add(command.to_bits());
        }
    }
    print(format_args!("{name} filter: {filtered}"));
    print(format_args!("{name} estimator: {estimated}"));
    print(format_args!("{name} control: {asked}"));
    print(format_args!("{name} mixer: {mixed}"));
}

/// Setpoints: mostly attitudes; also rates, the pipe and off it, a wrench.
fn setpoint(stretch: u32, noise: &mut Noise) -> Setpoint {
    let [roll, pitch, yaw_rate] = [0.5 * noise.unit(), 0.5 * noise.unit(), 0.5 * noise.unit()];
    let thrust = 18.0 + 16.0 * noise.unit();
    match stretch % 8 {
        2 => Setpoint::Rate {
            rate: Vec3::new(roll, pitch, yaw_rate),
            thrust,
        },
        4 => Setpoint::Resting { roll, pitch, thrust },
        5 => Setpoint::Escape {
            roll,
            pitch,
            yaw_rate,
            thrust,
        },
        6 => Setpoint::Direct {
            wrench: Wrench {
                thrust,
                roll,
                pitch,
                yaw: 0.1 * yaw_rate,
            },
        },
        7 => Setpoint::Idle,
        _ => Setpoint::Angle {
            roll,
            pitch,
            yaw_rate,
            thrust,
        },
    }
}

fn vector(noise: &mut Noise) -> Vec3 {
    Vec3::new(noise.unit(), noise.unit(), noise.unit())
}

fn add(fold: &mut Fold, v: Vec3) {
    for part in v.to_array() {
        fold.add(part.to_bits());
    }
}
