//! Force rates, fallbacks and signs of the terms, derived from the constants.

use super::*;

struct Bench {
    cfg: Config,
    arm: ArmGripper,
    thrust: f32,
    /// Tilt of an arm that does not follow its tendon, rad.
    stuck_at: Option<f32>,
}

impl Bench {
    fn new(p: &Params) -> Self {
        Self {
            cfg: Config::from_params(p),
            arm: ArmGripper::default(),
            thrust: 0.0,
            stuck_at: None,
        }
    }

    /// Tilt of an arm that bends by 0.024182 rad/N (the paper's arm at 6.9 %), rad.
    fn bent(&self) -> f32 {
        -0.2 - 0.024_182 * self.arm.force
    }

    /// Closes for one step with the tension at the force; returns the change of force, N.
    fn step(&mut self, pressure: f32) -> f32 {
        let before = self.arm.force;
        let input = ArmInput {
            close: true,
            pressure: Pressure::Known(pressure),
            turn_on: 0.0,
            thrust: self.thrust,
            tension: Some(before),
            tilt: Some(self.stuck_at.unwrap_or(self.bent())),
        };
        self.arm.step(&self.cfg, &input, DT).force - before
    }

    fn run(&mut self, pressure: f32, steps: u32) -> f32 {
        for _ in 0..steps {
            self.step(pressure);
        }
        self.arm.force
    }

    /// After 1.5 s of closing and 1.5 s at 950 Pa.
    fn holding(p: &Params) -> Self {
        let mut bench = Self::new(p);
        bench.run(0.0, 150);
        bench.run(950.0, 150);
        bench
    }
}

fn near(a: f32, b: f32, tolerance: f32) -> bool {
    (a - b).abs() <= tolerance
}

#[test]
fn an_arm_that_lost_touch_pulls_harder_at_30_n_a_second() {
    let mut bench = Bench::holding(&Params::default());
    // From 950 to 50 Pa the filter (80 rad/s: 4/9 of the way a step) passes 100 Pa after five steps: 900·(5/9)^5 = 48.
    // Then the integral alone wants 0.05·900 = 45 N/s and gets 30 N/s.
    bench.run(50.0, 5);
    for step in 0..40 {
        let rise = bench.step(50.0);
        assert!(near(rise, 0.30, 0.002), "step {step}: {rise} N");
    }
}

#[test]
fn an_arm_that_touches_follows_its_pressure_at_300_n_a_second_at_most() {
    // 0.05 N/Pa on the first step's filtered 4/9·500 Pa wants 11 N at once and gets 3 N.
    let p = Params {
        clamp_p: 0.05,
        ..Params::default()
    };
    for (pressure, change) in [(450.0, 3.0), (1450.0, -3.0)] {
        let mut bench = Bench::holding(&p);
        let first = bench.step(pressure);
        assert!(near(first, change, 1e-3), "{pressure} Pa: {first} N");
    }
}

#[test]
fn the_derivative_takes_force_away_while_the_pressure_rises() {
    // The derivative alone: 0.002 N s/Pa · 1000 Pa/s = 2 N less on a rise, 2 N more on a fall.
    let p = Params {
        clamp_p: 0.0,
        clamp_i: 0.0,
        clamp_d: 0.002,
        ..Params::default()
    };
    let mut bench = Bench::new(&p);
    bench.run(0.0, 150);
    let still = bench.run(400.0, 100);
    for (start, slope, change) in [(400.0, 10.0, -2.0), (800.0, -10.0, 2.0)] {
        for step in 1..=40 {
            bench.step(start + slope * step as f32);
        }
        assert!(
            near(bench.arm.force - still, change, 0.02),
            "{} {still}",
            bench.arm.force
        );
        let end = start + slope * 40.0;
        assert!(
            near(bench.run(end, 100), still, 0.02),
            "{} {still}",
            bench.arm.force
        );
    }
}

#[test]
fn a_touch_lost_for_good_falls_back_to_the_force_it_was_held_with() {
    let mut bench = Bench::new(&Params::default());
    bench.run(0.0, 150);
    let touched = bench.arm.force;
    // 400 Pa short on average for 2 s: 0.05·400 = 20 N/s, some 30 N more; then 2 s at the right pressure.
    for step in 0..200 {
        bench.step(300.0 + 2.5 * step as f32);
    }
    let usual = bench.run(950.0, 200);
    assert!(usual > touched + 20.0, "{touched} {usual}");
    // The sensor slips off; the pipe stops the arm.
    bench.stuck_at = Some(bench.bent());
    let most = (0..100).fold(0.0f32, |most, _| {
        bench.step(50.0);
        most.max(bench.arm.force)
    });
    assert!(bench.arm.fault() == Some(GripFault::Unfelt));
    assert!(
        most > usual + 7.0 && near(bench.arm.force, usual, 1.0),
        "{most} {}",
        bench.arm.force
    );
}

#[test]
fn a_touch_lost_at_once_falls_back_to_the_tendons_own_force() {
    // 2.5 N of thrust take 0.55·0.178/0.015·2.5 = 16.3 N of the tendon's force.
    let mut bench = Bench::new(&Params::default());
    bench.thrust = 2.5;
    let touched = bench.run(0.0, 150);
    bench.run(150.0, 5);
    bench.stuck_at = Some(bench.bent());
    bench.run(50.0, 100);
    assert!(bench.arm.fault() == Some(GripFault::Unfelt));
    assert!(
        near(bench.arm.force, touched, 1.5),
        "{touched} {}",
        bench.arm.force
    );
}

#[test]
fn a_lead_that_breaks_is_a_pressure_that_vanishes_within_one_step() {
    // Of 950 Pa: from over 0.3 (285 Pa) to below 0.02 (19 Pa).
    for (from, to, broken) in [
        (950.0, 0.0, true),
        (295.0, 18.0, true),
        (275.0, 0.0, false),
        (950.0, 20.0, false),
        (295.0, 20.0, false),
    ] {
        let mut bench = Bench::holding(&Params::default());
        let before = bench.run(from, 50);
        bench.step(to);
        assert_eq!(
            bench.arm.fault() == Some(GripFault::Sensor),
            broken,
            "{from} -> {to}"
        );
        if broken {
            assert!(near(bench.run(950.0, 100), before, 1e-6));
            assert!(bench.arm.fault() == Some(GripFault::Sensor));
        }
    }
    // An arm that lets go takes two steps of 10 ms.
    let mut bench = Bench::holding(&Params::default());
    bench.step(200.0);
    bench.step(0.0);
    assert!(bench.arm.fault().is_none());
}

#[test]
fn a_closed_arm_never_pays_out_below_one_newton() {
    // 5000 Pa against 950 Pa: the integral takes 200 N/s away, down to 1 N.
    let mut bench = Bench::holding(&Params::default());
    assert!(near(bench.run(5000.0, 500), 1.0, 1e-6));
    // No wind-up: at 600 Pa the proportional term returns 0.0035·4400 = 15 N, the integral 0.05·350 = 17.5 N in 1 s,
    // less the cost of filters and rate limit.
    let force = bench.run(600.0, 100);
    assert!((25.0..34.0).contains(&force), "{force}");
}
