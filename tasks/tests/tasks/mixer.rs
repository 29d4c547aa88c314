//! The mixer task's use of demands, voltage and the arms' sensors.

use embassy_time::Instant;
use sophie_control::allocation::mixer::Flexible;
use sophie_control::allocation::wrench::{Configuration, PerArm, Wrench};
use sophie_control::battery::Battery;
use sophie_control::chain::setpoint::Setpoint;
use sophie_control::chain::{Demand, MixOutput};
use sophie_tasks::flight::mixer;
use sophie_tasks::links::messages::ArmAngles;

use crate::rig::Rig;

/// A quarter of it is 4.425 N.
const WEIGHT: Wrench = Wrench {
    thrust: 17.7,
    roll: 0.0,
    pitch: 0.0,
    yaw: 0.0,
};
const HOVER: Demand = Demand::Wrench(WEIGHT);

struct Bench(Rig);

impl Bench {
    fn new() -> Self {
        let rig = Rig::new();
        let allocation = |p: &_| Flexible::new(Configuration::B, p);
        rig.time.spawn(mixer::run(rig.links, allocation));
        Self(rig)
    }

    fn run(&mut self, ms: u64, demand: Demand) -> MixOutput {
        self.0.run_with(ms, |links, at| links.demand.send(at, demand));
        self.0.links.mix.latest().unwrap().value
    }

    fn battery(&self, ratio: f32) {
        let battery = Battery {
            ratio,
            ..Battery::default()
        };
        self.0.links.battery.send(Instant::now(), battery);
    }

    fn with_arms(&mut self, ms: u64, demand: Demand, tilt: PerArm<Option<f32>>, age_ms: u64) -> MixOutput {
        let mut i = 0;
        self.0.run_with(ms, |links, at| {
            if i % 10 == 0 && at.as_millis() >= age_ms {
                let measured = Instant::from_millis(at.as_millis() - age_ms);
                links.arms.send(measured, ArmAngles::at(measured, tilt));
            }
            i += 1;
            links.demand.send(at, demand);
        });
        self.0.links.mix.latest().unwrap().value
    }
}

fn near(values: PerArm<f32>, expected: f32, tolerance: f32) -> bool {
    values.iter().all(|v| (v - expected).abs() <= tolerance)
}

#[test]
fn stopped_rotors_get_nothing_idle_ones_a_quarter_of_a_newton_and_hover_its_weight() {
    let mut bench = Bench::new();
    let stopped = bench.run(100, Demand::Stop);
    assert!(!stopped.running && stopped.yaw_gated);
    assert!(stopped.thrusts == [0.0; 4] && stopped.commands == [0.0; 4]);
    let idle = bench.run(100, Demand::Idle);
    assert!(idle.running && idle.yaw_gated && near(idle.thrusts, 0.25, 1e-6));
    let hover = bench.run(3000, HOVER);
    assert!(
        hover.running && !hover.yaw_gated && near(hover.thrusts, 4.425, 0.02),
        "{hover:?}"
    );
    assert_eq!(bench.0.links.mix.latest().unwrap().at.as_millis(), 3199);
    let stopped = bench.run(1, Demand::Stop);
    assert!(!stopped.running && stopped.commands == [0.0; 4]);
}

#[test]
fn a_sagging_battery_gets_larger_commands_for_the_same_thrust() {
    // 4.425 of 8.3 N = r²(0.75 u² + 0.25 u): u is 0.693 at nominal voltage, 0.785 at 0.9 of it.
    let mut bench = Bench::new();
    assert!(near(bench.run(3000, HOVER).commands, 0.693, 3e-3));
    bench.battery(0.9);
    assert!(near(bench.run(1, HOVER).commands, 0.785, 3e-3));
    assert!(near(bench.run(5000, HOVER).commands, 0.785, 3e-3));
    // Full thrust is 8.3 N·0.9².
    let most = bench.run(
        3000,
        Demand::Wrench(Wrench {
            thrust: 60.0,
            ..Wrench::default()
        }),
    );
    assert!(
        near(most.thrusts, 6.723, 1e-3) && near(most.commands, 1.0, 1e-3),
        "{most:?}"
    );
}

#[test]
fn every_arm_learns_from_each_of_its_readings_once_and_not_while_it_rests() {
    let mut bench = Bench::new();
    let tilt = bench.run(3000, HOVER).tilt;
    let felt = tilt.map(|t| Some(t + 0.1));
    // 2 % of the rest, 20 times in 0.2 s: 0.1·(1 - 0.98^20) = 0.0332 rad.
    let learnt = bench.with_arms(200, HOVER, felt, 0);
    assert!(near(learnt.tilt_bias, 0.0332, 2e-3), "{:?}", learnt.tilt_bias);
    assert!(
        learnt
            .tilt
            .iter()
            .zip(tilt)
            .all(|(now, before)| (now - before - 0.033).abs() < 0.01)
    );

    // On the pipe the arms do not hang free.
    let mut bench = Bench::new();
    bench.run(3000, HOVER);
    let rested = bench.with_arms(1000, Demand::Resting(WEIGHT), felt, 0);
    assert!(rested.tilt_bias == [0.0; 4] && rested.yaw_gated);
    let resting = Setpoint::Resting {
        roll: 0.0,
        pitch: 0.0,
        thrust: 17.7,
    };
    bench.0.links.setpoint.send(Instant::now(), resting);
    assert!(bench.with_arms(200, HOVER, felt, 0).tilt_bias[3] > 0.03);

    for (age, learns) in [(90, true), (110, false)] {
        let mut bench = Bench::new();
        bench.run(3000, HOVER);
        assert_eq!(
            bench.with_arms(200, HOVER, felt, age).tilt_bias[0] > 0.02,
            learns,
            "{age} ms"
        );
    }

    let mut bench = Bench::new();
    bench.run(3000, HOVER);
    let bias = bench
        .with_arms(200, HOVER, [felt[0], None, felt[2], None], 0)
        .tilt_bias;
    assert!(
        bias[0] > 0.03 && bias[1] == 0.0 && bias[2] > 0.03 && bias[3] == 0.0,
        "{bias:?}"
    );
}

#[test]
fn a_step_takes_the_time_between_two_samples() {
    // The low-passed thrust follows with 5 Hz, 32 ms: steps of 4 ms and of 1 ms open the yaw gate at the same time.
    let opens = |step_ms: u64| {
        let mut bench = Bench::new();
        bench.run(100, Demand::Idle);
        let mut ms = 0;
        loop {
            bench.0.links.demand.send(Instant::now(), HOVER);
            bench.0.run(step_ms);
            ms += step_ms;
            if !bench.0.links.mix.latest().unwrap().value.yaw_gated {
                return ms;
            }
        }
    };
    // 2.15 of 4.425 N, from 0.25: 32 ms·ln(4.175/2.275) = 19 ms.
    let (fine, coarse) = (opens(1), opens(4));
    assert!(
        (17..=24).contains(&fine) && (16..=28).contains(&coarse),
        "{fine} {coarse}"
    );
}
