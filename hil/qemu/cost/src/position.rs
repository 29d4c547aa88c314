//! The position estimate, the hold and the module's bytes: a vehicle that swings at one place, 1 m over the ground, with
//! flow and range or poses, 50 a second.

use core::fmt::Arguments;
use core::hint::black_box;

use embassy_time::Instant;
use sophie_conformance::fold::Noise;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::{Quat, Vec3};
use sophie_control::navigation::estimate::Estimate;
use sophie_control::navigation::fix::Fix;
use sophie_control::navigation::flow_range_sample::{Flow, GroundView, Range};
use sophie_control::navigation::inertial::Inertial;
use sophie_control::navigation::position_estimator::PositionEstimator;
use sophie_control::params::Params;
use sophie_control::position_hold::gains::Gains;
use sophie_control::position_hold::{BodyMotion, PositionHold, VelocityCommand};
use sophie_drivers::ground_module::GroundModule;
use sophie_drivers::msp::Message;
use sophie_ports::sensors::GroundDecoder;

use crate::counter::{Tally, gross, line};

/// Steps of the estimate, 200 Hz, and those before the first counted one: it is ready after half a second.
const STEPS: u32 = 4000;
const BEFORE: u32 = 400;
const STEP_US: u64 = 5000;
/// Steps between two measurements, and how late they are, in steps.
const EACH: u32 = 4;
const LATE: u32 = 6;
/// Step of the swing's angle, rad, and its steps from one side to the other.
const LEAN: f32 = 0.01;
const SWING: u32 = 24;

/// What a step takes.
struct Inputs {
    motion: Inertial,
    fix: Option<Fix>,
    view: Option<GroundView>,
}

#[derive(Clone, Copy, PartialEq)]
enum By {
    Flow,
    Pose,
}

struct Estimator {
    law: PositionEstimator,
    out: Option<Estimate>,
}

#[inline(never)]
fn estimate(e: &mut Estimator, i: &Inputs) {
    e.out = e.law.step(&i.motion, 0.0, i.fix.as_ref(), i.view.as_ref());
}

struct Hold {
    law: PositionHold,
    estimate: Estimate,
    out: sophie_control::chain::setpoint::Setpoint,
}

#[inline(never)]
fn hold(h: &mut Hold, (motion, wish): &(BodyMotion, VelocityCommand)) {
    h.out = h.law.step(&h.estimate, motion, wish, true, 0.01);
}

struct Decoder {
    module: GroundModule,
    out: Option<GroundView>,
}

#[inline(never)]
fn decode(d: &mut Decoder, (bytes, at): &([u8; 32], Instant)) {
    d.out = d.module.take(bytes, *at);
}

/// Attitude after `step` steps: it leans to one side and back.
fn attitude(step: u32) -> Quat {
    let turn = step % (2 * SWING);
    let lean = LEAN * (turn.min(2 * SWING - turn) as f32 - 0.5 * SWING as f32);
    Quat::from_euler(lean, 0.5 * lean, 0.0)
}

fn at_us(step: u32) -> u64 {
    1_000_000 + u64::from(step) * STEP_US
}

fn inputs(noise: &mut Noise, step: u32, by: By) -> Inputs {
    let mut vector = |size: f32| Vec3::new(noise.unit(), noise.unit(), noise.unit()) * size;
    let q = attitude(step);
    let accel = q.rotate_inverse(Vec3::new(0.0, 0.0, -GRAVITY)) + vector(0.3);
    let at = at_us(step);
    // The newest measurement stays where the next one is not there yet.
    let then = (step / EACH * EACH).saturating_sub(LATE);
    let (q0, q1) = (attitude(then.saturating_sub(EACH)), attitude(then));
    let turned = q0.conjugate() * q1;
    let error = vector(3e-3);
    let fix = Fix {
        at_us: at_us(then),
        position: Vec3::new(0.0, 0.0, -1.0) + error,
        heading: 0.0,
        variance: None,
        resets: 0,
    };
    let view = GroundView {
        flow: Some(Flow {
            until_us: at_us(then),
            seconds: 1e-6 * (u64::from(EACH) * STEP_US) as f32,
            angle: [2.0 * turned.x + error.x, 2.0 * turned.y + error.y],
            quality: 120,
        }),
        range: Some(Range {
            at_us: at_us(then),
            distance: Some(1.0 / q1.down_in_body().z + error.z),
            reach: (0.02, 8.0),
        }),
    };
    Inputs {
        motion: Inertial { at_us: at, q, accel },
        fix: (by == By::Pose).then_some(fix),
        view: (by == By::Flow).then_some(view),
    }
}

/// Counts and prints a line each.
pub fn run(print: &mut dyn FnMut(Arguments<'_>), overhead: u32) {
    let p = black_box(Params::default());
    let (mut quiet, mut hold_tally) = (Tally::new(), Tally::new());
    for (by, name) in [(By::Flow, "position-flow"), (By::Pose, "position-pose")] {
        let mut estimator = Estimator {
            law: PositionEstimator::new(&p),
            out: None,
        };
        let mut law: Option<Hold> = None;
        let (mut noise, mut news) = (Noise::new(11), Tally::new());
        for step in 0..STEPS {
            let inputs = black_box(inputs(&mut noise, step, by));
            let count = gross(estimate, &mut estimator, &inputs) - overhead;
            if step < BEFORE {
                continue;
            }
            // Without an estimate, or with what it gets left out, another law would be counted.
            let sound = estimator.law.fault().is_none();
            let found = estimator.out.filter(|e| sound && e.age < 0.1);
            let Some(found) = found else {
                panic!("{name}: no estimate in step {step}");
            };
            if step.is_multiple_of(EACH) {
                news.add(count);
            } else {
                quiet.add(count);
            }
            let motion = BodyMotion {
                q: inputs.motion.q,
                rate: Vec3::new(noise.unit(), noise.unit(), noise.unit()),
                carried: false,
            };
            let law = law.get_or_insert_with(|| Hold {
                law: PositionHold::begin(&p, &Gains::of(&p), 4.0 * p.thrust_max, &found, &motion),
                estimate: found,
                out: sophie_control::chain::setpoint::Setpoint::Idle,
            });
            law.estimate = found;
            if step.is_multiple_of(2) {
                let input = black_box((motion, VelocityCommand::default()));
                hold_tally.add(gross(hold, law, &input) - overhead);
            }
        }
        line(print, name, &news);
    }
    line(print, "position", &quiet);
    line(print, "hold", &hold_tally);
    line(print, "ground", &ground(&p, overhead));
}

/// Both frames of the module, in one read of its line.
fn ground(p: &Params, overhead: u32) -> Tally {
    let mut decoder = Decoder {
        module: GroundModule::from_params(p),
        out: None,
    };
    let (mut noise, mut tally) = (Noise::new(13), Tally::new());
    for step in 0..STEPS {
        let counts = [0, 1].map(|_| (20.0 * noise.unit()) as i32);
        let range = Message::Range {
            quality: 255,
            distance: 1000 + (20.0 * noise.unit()) as i32,
        };
        let flow = Message::Flow { quality: 120, counts };
        let mut bytes = [0; 32];
        let frames = [range.frame(), flow.frame()];
        for (byte, sent) in bytes.iter_mut().zip(frames.iter().flatten()) {
            *byte = *sent;
        }
        let at = Instant::from_micros(at_us(EACH * step));
        let count = gross(decode, &mut decoder, &black_box((bytes, at))) - overhead;
        if step >= BEFORE {
            let whole = decoder.out.is_some_and(|view| view.flow.is_some());
            assert!(whole, "no flow in step {step}");
            tally.add(count);
        }
    }
    tally
}
