//! Steps of `sophie bringup` that run the rotors of a tied vehicle: how its arms bend, and what shakes it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use sophie_bringup::STEPS;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::Params;
use sophie_sim::scenario::Scenario;

use super::board::{Board, Hands};
use super::bringup::Builder;
use super::run;
use sophie_test_support::command::Temp;

/// Between two movements of what hands do not hold.
const ROUND: Duration = Duration::from_millis(2);
/// Battery of a board on the table, V.
const VOLTS: f64 = 15.2;

/// A builder who begins the step `id` and skips those before.
fn begins(temp: &Temp, board: &Board, id: &str) -> Builder {
    let mut builder = Builder::begins(temp, board, &[]);
    for step in STEPS.iter().take_while(|step| step.id != id) {
        builder.at(&format!("({})", step.id), "s");
    }
    // Who renews an order needs time on the wall.
    board.hands(|hands| hands.unhurried = true);
    builder.step(id);
    builder.at("Type tied", "tied");
    builder
}

/// Runs `work` while `moves` acts on the board.
fn meanwhile(moves: impl Fn() + Send + Sync, work: impl FnOnce()) {
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                moves();
                std::thread::sleep(ROUND);
            }
        });
        let result = std::panic::catch_unwind(std::panic::AssertUnwindSafe(work));
        over.store(true, Ordering::Relaxed);
        if let Err(panic) = result {
            std::panic::resume_unwind(panic);
        }
    });
}

/// Thrust of a rotor by the default parameters, N.
fn thrust(drive: f64) -> f64 {
    let p = Params::DEFAULT;
    let q = f64::from(p.thrust_curve);
    let ratio = (VOLTS / f64::from(p.battery_nominal)).powf(f64::from(p.thrust_volt_exp));
    f64::from(p.thrust_max) * ratio * (q * drive + 1.0 - q) * drive
}

#[test]
fn arms_that_their_rotors_bend_give_their_equation() {
    let temp = Temp::new("bringup-arm-table");
    let mut scenario = Scenario::default_mission();
    scenario.vehicle.arm_gain = [1.25, 1.3, 1.2, 1.25];
    scenario.vehicle.arm_offset = [0.03, -0.03, 0.02, -0.02];
    let specs: [_; 4] = std::array::from_fn(|arm| scenario.arm_spec(arm));
    let board = Board::new(Hands::default());
    let mut builder = begins(&temp, &board, "arm-table");
    let bends = || {
        let drives = board.outputs().motors;
        board.hands(|hands| {
            for arm in 0..4 {
                hands.tilt[arm] = specs[arm].static_tilt(thrust(drives[arm])) as f32;
            }
        });
    };
    meanwhile(bends, || {
        for percent in [30, 45, 60, 75, 90] {
            builder.at(&format!("Enter runs all rotors at {percent} %"), "");
        }
        builder.hears("arm 2 bends 1.04 ");
        builder.hears("gain_k 7.75 -> 1");
        builder.hears("passed");
    });
    builder.at("(vibration)", "q");
    assert_eq!(builder.ends().0, Some(1));
    let p = board.stored();
    let found = |thrust: f64| {
        let infill = f64::from(p.infill);
        let (a, b) = (
            f64::from(p.arm_a1) + infill * f64::from(p.arm_a2),
            f64::from(p.arm_b1) + infill * f64::from(p.arm_b2),
        );
        let level = f64::from(p.arm_level_share * p.thrust_max);
        let rise = |t: f64| (a + b * t) * t;
        rise(thrust) - rise(level)
    };
    for newton in [2.0, 4.4, 6.0] {
        let truth = specs
            .iter()
            .map(|spec| spec.static_tilt(newton).to_degrees())
            .sum::<f64>()
            / 4.0;
        assert!(
            (found(newton) - truth).abs() < 0.5,
            "{newton} N: {} {truth}",
            found(newton)
        );
    }
    let fitted = run(&temp, &["fit-arm", "arm-bench.csv", "--out", "fitted"]);
    assert_eq!(fitted.status, Some(0), "{fitted:?}");
}

#[test]
fn a_vehicle_that_vibrates_fails_until_it_is_balanced() {
    let temp = Temp::new("bringup-vibration");
    let board = Board::new(Hands::default());
    let mut builder = begins(&temp, &board, "vibration");
    for (size, judged) in [(14.0, "balance each propeller"), (3.0, "passed")] {
        let up = AtomicBool::new(false);
        let shakes = || {
            let sign = if up.fetch_xor(true, Ordering::Relaxed) {
                1.0
            } else {
                -1.0
            };
            let turn = board.outputs().motors.iter().all(|drive| *drive > 0.1);
            let size = if turn { sign * size } else { 0.0 };
            board.hands(|hands| hands.force = Vec3::new(0.0, 0.0, size - GRAVITY));
            // Another time than the board's.
            std::thread::sleep(ROUND * 2);
        };
        meanwhile(shakes, || {
            builder.at("Enter runs all rotors at 70 %", "");
            builder.hears("vibration 0.0 0.0 ");
            builder.hears(judged);
        });
        if size > 10.0 {
            builder.hears("FAILED");
            builder.at("Enter tries it again", "");
            builder.at("Enter begins", "");
            builder.at("Type tied", "tied");
        }
    }
    builder.at("(final)", "q");
    assert_eq!(builder.ends().0, Some(1));
}
