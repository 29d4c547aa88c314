//! The fit of four arms' tables on vehicles as builders have them: tied down, all rotors at once, thrust by the parameters
//! of the step before, tilt by the arms' own sensors.

mod drawn;

use sophie_control::pilot::static_thrust_test::Rotors;
use sophie_fit::arm_data::Point;
use sophie_fit::arm_table::{self, ArmPoint, ArmsFit};
use sophie_sim::scenario::Scenario;
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::thrust_stand::ThrustStand;

use drawn::vehicle;

const VEHICLES: u64 = 100;
/// As `sophie bringup` runs them, share of full drive.
const DRIVES: [f64; 5] = [0.3, 0.45, 0.6, 0.75, 0.9];
const TABLE_1: [f64; 4] = [2.4387, -0.1997, -0.162, 0.0151];
/// Largest error of the thrust that the step before leaves, share: the row `vehicle.thrust_max_n`, and the curve's.
const THRUST_ERROR: f64 = 0.03;

fn session(scenario: &Scenario, seed: u64) -> ArmsFit {
    let streams = Streams::new(seed);
    let mut stand = ThrustStand::new(scenario, streams);
    let known = 1.0 + streams.within("thrust", -THRUST_ERROR, THRUST_ERROR);
    let mut points = Vec::new();
    for drive in DRIVES {
        let (thrust, read) = stand.run_of_arms(Rotors::All, drive);
        stand.rest(20.0);
        for (arm, (thrust, tilt)) in thrust.into_iter().zip(read.tilt).enumerate() {
            points.push(ArmPoint {
                arm,
                point: Point {
                    infill: scenario.vehicle.infill,
                    thrust: known * thrust,
                    tilt: tilt.to_degrees(),
                    power: 1.0,
                },
            });
        }
    }
    arm_table::fit(&points, TABLE_1).unwrap()
}

/// Mean tilt of the four arms at `thrust` N, degrees.
fn tilt(scenario: &Scenario, thrust: f64) -> f64 {
    let tilts = (0..4).map(|arm| scenario.arm_spec(arm).static_tilt(thrust));
    (tilts.sum::<f64>() / 4.0).to_degrees()
}

#[test]
fn a_table_of_a_day_leaves_what_the_rows_of_the_arms_say() {
    let (mut tilts, mut levels, mut gains, mut offsets, mut inside) = (vec![], vec![], vec![], vec![], 0);
    for seed in 1..=VEHICLES {
        let scenario = vehicle(seed);
        let found = session(&scenario, seed);
        let fit = &found.all;
        // What the mixer takes: the tilt about hover, its rise, and where it is none.
        for thrust in [3.0, 4.4, 6.0] {
            tilts.push(fit.tilt(found.infill, thrust, 1.0) - tilt(&scenario, thrust));
        }
        let rise = |tilt: &dyn Fn(f64) -> f64| tilt(5.4) - tilt(3.4);
        let found_rise = rise(&|t| fit.tilt(found.infill, t, 1.0));
        gains.push(found_rise / rise(&|t| tilt(&scenario, t)) - 1.0);
        let level = (0..8000)
            .map(|i| 1e-3 * f64::from(i))
            .find(|t| tilt(&scenario, *t) >= 0.0);
        if let (Some(truth), Some(level)) = (level, fit.level_thrust(found.infill)) {
            levels.push(level - truth);
        }
        let mean = scenario.vehicle.arm_offset.iter().sum::<f64>() / 4.0;
        for (own, offset) in found.arms.iter().zip(scenario.vehicle.arm_offset) {
            let (value, half) = own.offset;
            let truth = (offset - mean).to_degrees();
            offsets.push(value - truth);
            inside += u64::from((value - truth).abs() <= half);
        }
    }
    let show = |name: &str, all: &mut Vec<f64>| {
        all.sort_by(f64::total_cmp);
        let at = |share: f64| all[(share * (all.len() - 1) as f64) as usize];
        println!(
            "{name}: {:.3} {:.3} {:.3} {:.3} {:.3}",
            at(0.0),
            at(0.025),
            at(0.5),
            at(0.975),
            at(1.0)
        );
        (at(0.025), at(0.975))
    };
    let tilts = show("tilt, deg", &mut tilts);
    let gains = show("gain", &mut gains);
    let levels = show("level thrust, N", &mut levels);
    let _ = show("offset of an arm, deg", &mut offsets);
    println!("offsets inside: {inside} of {}", 4 * VEHICLES);
    // The rows `vehicle.arm_gain`, ± 5 %, and `vehicle.arm_level_n`, ± 0.17 N: the same scatter as evenly within these.
    assert!(gains.0 > -0.07 && gains.1 < 0.07, "{gains:?}");
    assert!(levels.0 > -0.25 && levels.1 < 0.25, "{levels:?}");
    assert!(tilts.0 > -1.2 && tilts.1 < 1.2, "{tilts:?}");
    assert!(inside * 100 >= 93 * 4 * VEHICLES, "{inside}");
}
