use super::*;
use crate::allocation::wrench::{Configuration, Wrench};
use crate::chain::spin::Spin;
use crate::chain::static_thrust::{Rotors, StaticThrust};
use crate::maths::scalar::GRAVITY;

struct Bench {
    mixing: Mixing,
    weight: f32,
    at_us: u64,
}

impl Bench {
    fn new() -> Self {
        let p = Params::default();
        let mut bench = Self {
            mixing: Mixing::new(&p, Flexible::new(Configuration::B, &p)),
            weight: p.mass * GRAVITY,
            at_us: 0,
        };
        bench.run(2000, &bench.hover(), &Surroundings::default());
        bench
    }

    fn hover(&self) -> Demand {
        Demand::Wrench(self.wrench())
    }

    fn wrench(&self) -> Wrench {
        Wrench {
            thrust: self.weight,
            ..Wrench::default()
        }
    }

    fn run(&mut self, steps: usize, demand: &Demand, surroundings: &Surroundings) -> MixOutput {
        let mut mix = MixOutput::default();
        for _ in 0..steps {
            self.at_us += 1000;
            self.mixing.step(self.at_us, demand, surroundings, &mut mix);
        }
        mix
    }

    /// Readings 0.1 rad above the model, none for arm `without`.
    fn arms(&self, without: usize) -> Surroundings {
        let mut tilt = self.mixing.allocation.tilt().tilt().map(|tilt| Some(tilt + 0.1));
        tilt[without] = None;
        Surroundings {
            battery_ratio: None,
            thrust_root: None,
            arms: Some(ArmReading {
                at_us: self.at_us,
                tilt,
            }),
        }
    }
}

#[test]
fn one_arm_a_step_learns_from_each_reading_once() {
    let mut bench = Bench::new();
    let hover = bench.hover();
    let arms = bench.arms(2);
    let mut last = [0.0; 4];
    for turn in [Some(0), Some(1), None, Some(3), None, None, None, None] {
        let bias = bench.run(1, &hover, &arms).tilt_bias;
        for arm in 0..4 {
            let learns = turn == Some(arm);
            assert!(
                (bias[arm] > last[arm]) == learns,
                "{turn:?}: {bias:?} after {last:?}"
            );
        }
        last = bias;
    }
    // An early reading starts again at the first arm.
    let arms = bench.arms(2);
    bench.run(1, &hover, &arms);
    let arms = bench.arms(0);
    let before = bench.run(1, &hover, &arms).tilt_bias;
    let after = bench.run(1, &hover, &arms).tilt_bias;
    assert!(
        before[1] == last[1] && after[1] > last[1],
        "{before:?}, {after:?}"
    );
}

#[test]
fn resting_arms_teach_nothing_and_what_was_taken_before_still_does() {
    let mut bench = Bench::new();
    let (hover, resting) = (bench.hover(), Demand::Resting(bench.wrench()));
    let untaught = bench.run(5, &resting, &bench.arms(3)).tilt_bias;
    assert!(untaught == [0.0; 4], "{untaught:?}");
    bench.run(1, &hover, &bench.arms(3));
    let [first, second, third, _] = bench.run(2, &resting, &bench.arms(3)).tilt_bias;
    assert!(first > 0.0 && second > 0.0 && third > 0.0);
}

#[test]
fn yaw_is_given_in_the_air_and_not_on_the_pipe_and_stopped_rotors_get_nothing() {
    let mut bench = Bench::new();
    let nothing = Surroundings::default();
    let wrench = Wrench {
        yaw: 0.02,
        ..bench.wrench()
    };
    let [a, b, c, d] = bench.run(1, &Demand::Wrench(wrench), &nothing).thrusts;
    assert!(a - b - c + d > 0.1, "{a} {b} {c} {d}");
    let mix = bench.run(1000, &Demand::Resting(wrench), &nothing);
    let [a, b, c, d] = mix.thrusts;
    assert!(
        mix.yaw_gated && mix.running && (a - b - c + d).abs() < 1e-3,
        "{mix:?}"
    );
    let mix = bench.run(1, &Demand::Idle, &nothing);
    assert!(
        mix.running && mix.thrusts == [Params::default().thrust_idle; 4],
        "{mix:?}"
    );
    let spin = |drive| Demand::Spin(Spin::at(1, drive));
    let mix = bench.run(1, &spin(0.08), &nothing);
    assert!(
        mix.running && mix.thrusts == [0.0; 4] && mix.commands == [0.0, 0.08, 0.0, 0.0],
        "{mix:?}"
    );
    let thrust = |rotors, drive| Demand::StaticThrust(StaticThrust { rotors, drive });
    let mix = bench.run(1, &thrust(Rotors::One(2), 0.9), &nothing);
    assert!(
        mix.running && mix.thrusts == [0.0; 4] && mix.commands == [0.0, 0.0, 0.9, 0.0],
        "{mix:?}"
    );
    for bad in [0.5, f32::NAN] {
        assert_eq!(bench.run(1, &spin(bad), &nothing).commands, [0.0; 4], "{bad}");
    }
    let mix = bench.run(1, &Demand::Stop, &nothing);
    assert!(
        !mix.running && mix.thrusts == [0.0; 4] && mix.commands == [0.0; 4],
        "{mix:?}"
    );
}

#[test]
fn without_a_measured_battery_it_counts_as_nominal() {
    let command = |battery_ratio| {
        let mut bench = Bench::new();
        let surroundings = Surroundings {
            battery_ratio,
            thrust_root: None,
            arms: None,
        };
        let [command, ..] = bench.run(1, &bench.hover(), &surroundings).commands;
        command
    };
    assert!(command(None) == command(Some(1.0)));
    assert!(command(Some(0.9)) > 1.05 * command(None));
}

#[test]
fn a_stronger_vehicle_gives_the_thrust_asked_for_and_all_that_it_has() {
    let p = Params::default();
    let mut mixes = [1.0f32, 1.2, 0.85].map(|factor| {
        let surroundings = Surroundings {
            battery_ratio: Some(1.1),
            thrust_root: Some(factor.sqrt()),
            arms: None,
        };
        let bench = || {
            let bench = Bench::new();
            let hover = bench.hover();
            (bench, hover)
        };
        let (mut hovers, hover) = bench();
        let hover = hovers.run(200, &hover, &surroundings);
        let full = Demand::Wrench(Wrench {
            thrust: 100.0,
            ..Wrench::default()
        });
        let full = bench().0.run(2000, &full, &surroundings);
        (factor, hover, full)
    });
    let (_, plain, _) = mixes[0];
    let curve = ThrustCurve::from_params(&p);
    for (factor, hover, full) in &mut mixes {
        let given = hover.commands.map(|u| *factor * curve.thrust(u, 1.1));
        for (given, asked) in given.iter().zip(plain.thrusts) {
            assert!((given - asked).abs() < 1e-3, "{factor}: {given} of {asked}");
        }
        let most = p.thrust_max * *factor;
        assert!(
            full.thrusts.iter().all(|t| (t - most).abs() < 0.01),
            "{factor}: {full:?}"
        );
    }
}
