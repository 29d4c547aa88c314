//! `sophie bringup`'s step `thrust`: the board's own runs on its outputs, the scale's readings from the simulator's rotors,
//! battery and arms.

use sophie_bringup::STEPS;
use sophie_control::allocation::wrench::PerArm;
use sophie_control::params::Params;
use sophie_control::pilot::rc::Sticks;
use sophie_control::pilot::static_thrust_test::Rotors;
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::thrust_stand::{Reading, ThrustStand};
use sophie_test_support::command::Temp;

use super::board::{Board, Hands};
use super::bringup::Builder;

/// A vehicle that is 11 % stronger than the parameters have it, and of which no two rotors are alike.
const VEHICLE: &str =
    "[vehicle]\nthrust_max_n = 9.2\nrotor_thrust = [0.96, 1.04, 1.01, 0.99]\nthrust_voltage_power = 1.65\n";
/// What the vehicle on its stand shows to the board while a run lasts.
fn shown(board: &Board, reading: &Reading) {
    board.hands(|hands| {
        hands.counts.battery_voltage = (100.0 * reading.voltage).round() as u16;
        hands.tilt = reading.tilt.map(|tilt| tilt as f32);
    });
}

/// Runs `rotors` at `percent`; the scale's reading is typed.
fn one(builder: &mut Builder, board: &Board, stand: &mut ThrustStand, rotors: Rotors, percent: u32) {
    let name = match rotors {
        Rotors::All => "all rotors".to_owned(),
        Rotors::One(rotor) => format!("rotor {}", rotor + 1),
    };
    let drive = f64::from(percent) * 0.01;
    let reading = stand.run(rotors, drive);
    stand.rest(20.0);
    builder.hears(&format!("Enter runs {name} at {percent} %"));
    shown(board, &reading);
    board.pass(1.0);
    builder.types("");
    // The rise, and most of the time at the drive.
    board.pass(2.0 * drive + 3.0);
    let expected: PerArm<f64> = core::array::from_fn(|rotor| if rotors.has(rotor) { drive } else { 0.0 });
    let motors = board.outputs().motors;
    for (motor, expected) in motors.iter().zip(expected) {
        assert!(
            (motor - expected).abs() < 1e-3,
            "{name} at {percent} %: {motors:?}"
        );
    }
    builder.at("What the scale showed", &format!("{:.0}", reading.grams));
}

/// A builder at the step, the vehicle tied down.
fn at_the_step(temp: &Temp, board: &Board) -> Builder {
    let mut builder = Builder::begins(temp, board, &[]);
    for step in STEPS.iter().take_while(|step| step.id != "thrust") {
        builder.at(&format!("({})", step.id), "s");
    }
    builder.step("thrust");
    builder.at("Type tied", "yes");
    builder.at("Type tied", "tied");
    builder
}

fn hands() -> Hands {
    Hands {
        unhurried: true,
        sticks: Some(Sticks::default()),
        ..Hands::default()
    }
}

#[test]
fn thrust_of_a_strong_and_uneven_vehicle_is_found_on_a_scale() {
    let scenario = Scenario::parse(VEHICLE, "strong", &Overrides::default()).unwrap();
    let mut stand = ThrustStand::new(&scenario, Streams::new(5));
    stand.change_battery(&scenario, 1.0);
    let (temp, board) = (Temp::new("bringup-thrust"), Board::new(hands()));
    let mut builder = at_the_step(&temp, &board);
    for (battery, alone) in [(1.0, true), (0.35, false)] {
        if battery < 1.0 {
            builder.at("A used battery", "u");
            stand.rest(180.0);
            stand.change_battery(&scenario, battery);
            builder.at("Type tied", "tied");
        }
        for percent in [45, 55, 70, 85, 100] {
            one(&mut builder, &board, &mut stand, Rotors::All, percent);
        }
        for rotor in (0..4).filter(|_| alone) {
            for percent in [55, 85] {
                one(&mut builder, &board, &mut stand, Rotors::One(rotor), percent);
            }
        }
    }
    builder.hears("thrust_max 8.3 -> ");
    builder.hears("storing");
    builder.hears("passed");
    builder.at("(lag)", "q");
    let (status, said, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(1), ""), "{said}");
    let p = board.stored();
    let rotor = scenario.vehicle.rotor;
    for command in [0.55f64, 0.7, 0.85] {
        let q = f64::from(p.thrust_curve);
        let told = f64::from(p.thrust_max) * (q * command + 1.0 - q) * command;
        let share = told / rotor.steady_thrust(command, 14.8);
        assert!((share - 1.0).abs() < 0.035, "{command}: {share}\n{said}");
    }
    assert!((p.thrust_volt_exp - 1.65).abs() < 0.15, "{said}");
    for (trim, truth) in [
        (p.thrust_trim_1, 0.96),
        (p.thrust_trim_2, 1.04),
        (p.thrust_trim_3, 1.01),
        (p.thrust_trim_4, 0.99),
    ] {
        assert!((trim - truth).abs() < 0.02, "{trim} for {truth}\n{said}");
    }
    let level = Params::DEFAULT.arm_level_share * Params::DEFAULT.thrust_max;
    assert!((p.arm_level_share * p.thrust_max - level).abs() < 2e-3, "{said}");
}

#[test]
fn the_arm_switch_enter_and_a_lost_station_stop_the_rotors() {
    let (temp, board) = (Temp::new("bringup-thrust-stop"), Board::new(hands()));
    let mut builder = at_the_step(&temp, &board);
    let turns = |board: &Board| board.outputs().motors.iter().any(|motor| *motor > 0.0);
    builder.at("Enter runs all rotors at 45 %", "");
    board.pass(2.0);
    assert!(turns(&board));
    board.hands(|hands| {
        hands.sticks = Some(Sticks {
            arm_switch: true,
            ..Sticks::default()
        });
    });
    builder.hears("refused: arm switch on: turn it off first");
    assert!(!turns(&board));
    board.hands(|hands| hands.sticks = Some(Sticks::default()));
    board.pass(0.5);
    builder.at("Type tied", "tied");
    builder.at("Enter runs all rotors at 45 %", "");
    board.pass(2.0);
    assert!(turns(&board));
    builder.types("");
    builder.hears("stopped");
    builder.at("Type tied", "tied");
    assert!(!turns(&board));
    // The builder's computer goes away.
    builder.at("Enter runs all rotors at 45 %", "");
    board.pass(2.0);
    assert!(turns(&board));
    builder.loses_the_computer();
    board.pass(2.0);
    assert!(!turns(&board));
}
