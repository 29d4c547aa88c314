//! The fit of static thrust on vehicles as builders have them: drawn from the table of uncertain numbers, tied down on a
//! scale with errors of its own, read as `sophie bringup` has it read.

mod drawn;

use sophie_control::pilot::static_thrust_test::Rotors;
use sophie_fit::thrust::{self, ThrustFit};
use sophie_fit::thrust_data::{GRAVITY, Reading};
use sophie_sim::plant::rotor::{NOMINAL_VOLTAGE, Rotor};
use sophie_sim::scenario::Scenario;
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::thrust_stand::ThrustStand;

use drawn::vehicle;

const VEHICLES: u64 = 100;
/// Commands of all four rotors together, and of each alone, share of full drive.
const TOGETHER: [f64; 5] = [0.45, 0.55, 0.7, 0.85, 1.0];
const ALONE: [f64; 2] = [0.55, 0.85];
/// Rest between two runs, s: a person reads and types.
const REST: f64 = 20.0;
/// Rest while the battery is changed and the motors cool, s.
const COOL: f64 = 180.0;
/// Charge of the used battery.
const USED: f64 = 0.35;

fn read(stand: &mut ThrustStand, rotor: Option<usize>, command: f64) -> Reading {
    let read = stand.run(rotor.map_or(Rotors::All, Rotors::One), command);
    stand.rest(REST);
    let tilt = rotor.map_or(read.tilt.iter().sum::<f64>() / 4.0, |rotor| read.tilt[rotor]);
    Reading {
        command,
        voltage: read.voltage,
        rotor,
        force: 1e-3 * GRAVITY * read.grams,
        tilt,
    }
}

/// Readings of a whole session; with a second battery, used, if there is one.
fn session(scenario: &Scenario, seed: u64, second: bool) -> Vec<Reading> {
    let mut stand = ThrustStand::new(scenario, Streams::new(seed));
    stand.change_battery(scenario, 1.0);
    let mut rows: Vec<Reading> = Vec::new();
    for command in TOGETHER {
        rows.push(read(&mut stand, None, command));
    }
    for rotor in 0..4 {
        for command in ALONE {
            rows.push(read(&mut stand, Some(rotor), command));
        }
    }
    if second {
        stand.rest(COOL);
        stand.change_battery(scenario, USED);
        for command in TOGETHER {
            rows.push(read(&mut stand, None, command));
        }
    }
    rows
}

/// What is true of a vehicle on its day, cold.
struct Truth {
    /// Thrust of a mean rotor at full drive and nominal voltage, N.
    max: f64,
    trims: [f64; 4],
    power: f64,
}

impl Truth {
    fn of(scenario: &Scenario) -> Self {
        let v = &scenario.vehicle;
        let mean = v.rotor_thrust.iter().sum::<f64>() / 4.0;
        Self {
            max: at(scenario, 1.0, NOMINAL_VOLTAGE),
            trims: v.rotor_thrust.map(|factor| factor / mean),
            power: v.rotor.voltage_power.unwrap_or(1.67),
        }
    }
}

/// Steady thrust of a mean rotor on the day, N.
fn at(scenario: &Scenario, command: f64, voltage: f64) -> f64 {
    let v = &scenario.vehicle;
    let mean = v.rotor_thrust.iter().sum::<f64>() / 4.0;
    let mut rotor = Rotor::new(0, 1.0, v.rotor).in_air(mean, scenario.world.air.density);
    // Cold: ten time constants of the slowest rotor are 2 % of the motor's thermal one.
    for _ in 0..100 {
        rotor.step(1e-2, command, voltage);
    }
    rotor.thrust() * (1.0 - v.air.wash.loss)
}

#[derive(Default)]
struct Tally {
    inside: [u32; 4],
    of: [u32; 4],
    errors: [Vec<f64>; 4],
    widths: [Vec<f64>; 4],
}

impl Tally {
    fn count(&mut self, what: usize, error: f64, half: f64) {
        self.of[what] += 1;
        self.inside[what] += u32::from(error.abs() <= half);
        self.errors[what].push(error);
        self.widths[what].push(half);
    }

    fn add(&mut self, fit: &ThrustFit, truth: &Truth) {
        self.count(0, fit.max.value / truth.max - 1.0, fit.max.half / truth.max);
        for (found, truth) in fit.trims.iter().flatten().zip(truth.trims) {
            self.count(1, found.value - truth, found.half);
        }
        if let Some(power) = fit.power {
            self.count(2, power.value - truth.power, power.half);
        }
    }

    fn share(&self, what: usize) -> f64 {
        f64::from(self.inside[what]) / f64::from(self.of[what].max(1))
    }

    /// The error that `share` of all stay within.
    fn within(&self, what: usize, share: f64) -> f64 {
        let mut errors: Vec<f64> = self.errors[what].iter().map(|e| e.abs()).collect();
        errors.sort_by(f64::total_cmp);
        errors[((share * errors.len() as f64) as usize).min(errors.len() - 1)]
    }

    fn mean(&self, what: usize) -> f64 {
        self.errors[what].iter().sum::<f64>() / self.errors[what].len() as f64
    }

    fn width(&self, what: usize) -> f64 {
        self.widths[what].iter().sum::<f64>() / self.widths[what].len() as f64
    }
}

/// Thrust of the nominal rotor at full drive in the standard's air, N, by what a fit has found and the table's share that
/// the arms receive.
fn nominal(scenario: &Scenario, found: f64) -> f64 {
    let v = &scenario.vehicle;
    let mean = v.rotor_thrust.iter().sum::<f64>() / 4.0;
    found / (v.rotor.air_ratio(scenario.world.air.density) * mean * (1.0 - v.air.wash.loss))
}

/// Sessions of all vehicles; how far the law is from the rotors between 50 and 90 %, sorted.
fn tallied(second: bool) -> (Tally, Vec<f64>) {
    let (mut tally, mut law) = (Tally::default(), Vec::new());
    for seed in 0..VEHICLES {
        let scenario = vehicle(seed);
        let rows = session(&scenario, seed, second);
        let fit = thrust::fit(&rows, NOMINAL_VOLTAGE).unwrap();
        tally.add(&fit, &Truth::of(&scenario));
        let table = nominal(&scenario, fit.max.value) / scenario.vehicle.rotor.thrust_max - 1.0;
        tally.count(3, table, TABLE[0]);
        let (q, power) = (fit.curve.value, fit.power.map_or(thrust::POWER, |p| p.value));
        for u in [0.5, 0.6, 0.7, 0.8, 0.9] {
            let told = fit.max.value * (15.4f64 / 14.8).powf(power) * (q * u + 1.0 - q) * u;
            law.push((told / at(&scenario, u, 15.4) - 1.0).abs());
        }
    }
    law.sort_by(f64::total_cmp);
    (tally, law)
}

/// Errors of the calibration in the table of uncertain numbers: of `vehicle.thrust_max_n` and of each rotor, shares, and of
/// the voltage's power.
const TABLE: [f64; 3] = [0.02, 0.015, 0.11];

#[test]
fn the_stated_intervals_hold_the_truth_and_the_table_has_the_errors_measured() {
    for second in [true, false] {
        let (tally, law) = tallied(second);
        let names = ["thrust_max", "trims", "power", "table's thrust_max_n"];
        for (what, name) in names
            .into_iter()
            .enumerate()
            .filter(|(what, _)| tally.of[*what] > 0)
        {
            println!(
                "second battery {second}, {name}: {:.3} of {} inside {:.4}, 95 % within {:.4}, all within {:.4}, mean {:+.4}",
                tally.share(what),
                tally.of[what],
                tally.width(what),
                tally.within(what, 0.95),
                tally.within(what, 1.0),
                tally.mean(what),
            );
        }
        println!(
            "law within {:.4} in 95 %, {:.4} in all",
            law[law.len() * 95 / 100],
            law[law.len() - 1]
        );
        for what in [0, 1] {
            assert!(tally.share(what) >= 0.92, "{}", names[what]);
        }
        // Wide enough is not enough: the intervals are no wider than twice what they hold.
        for what in [0, 1] {
            let within = tally.within(what, 0.95);
            assert!(tally.width(what) < 2.0 * within, "{}: {within}", names[what]);
        }
        // A battery that tells no power leaves up to 1 % of it at 15.4 V.
        let most = if second { 0.03 } else { 0.04 };
        assert!(law[law.len() * 95 / 100] < most);
        if second {
            assert_eq!(u64::from(tally.of[2]), VEHICLES, "two batteries tell the power");
            assert!(tally.share(2) >= 0.9);
            // The table's errors are evenly spread: what 95 % stay within.
            for (what, table) in [(3, TABLE[0]), (1, TABLE[1]), (2, TABLE[2])] {
                let within = tally.within(what, 0.95);
                assert!(
                    within <= table && within > 0.6 * table,
                    "{}: {within}",
                    names[what]
                );
            }
        } else {
            assert_eq!(tally.of[2], 0, "one battery does not");
        }
    }
}
