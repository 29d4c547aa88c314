//! The tendons' steps of `sophie bringup` on a vehicle that stands on a box, whose true numbers the plant has, and `sophie
//! fit-tendon`.

use std::fs;
use std::sync::Arc;

use sophie_bringup::STEPS;
use sophie_control::params::{Params, ServoMarks};
use sophie_fit::servo_steps::bench::{Given, Rest, tilts};
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_test_support::command::{Temp, refused, sophie, text};

use super::board::{Board, Hands};
use super::bringup::Builder;

/// A vehicle with soft, rubbing tendons, one of them knotted too long.
const VEHICLE: &str = "vehicle.known = \"as-built\"\nvehicle.tendon_stiffness_n_m = [3200, 2800, 3000, 3000]\n\
                       vehicle.tendon_friction = [0.3, 0.5, 0.3, 0.3]\nfaults.tendon_slack_mm = [1.5, 0, 5, 0]\n\
                       vehicle.servo_stop_deg = 1.5\nvehicle.servo_backlash_deg = 0.5\nvehicle.arm_gain = [1.1, 0.9, 1, 1]\n";
/// A bottle, N.
const WEIGHT: f64 = 3.2;

/// Hangs the weight on arm `number` and takes it off, as asked.
fn weighed(builder: &mut Builder, board: &Board, number: usize) {
    for _ in 0..4 {
        for (asked, weight) in [("Hang the weight", WEIGHT), ("Take the weight off", 0.0)] {
            builder.hears(asked);
            board.hands(|hands| hands.hung[number - 1] = weight);
            board.pass(2.0);
            builder.types("");
        }
    }
}

#[test]
fn tendons_are_measured_by_their_servos_and_a_known_weight() {
    let temp = Temp::new("bringup-tendon");
    let scenario = Scenario::parse(VEHICLE, "vehicle", &Overrides::default()).unwrap();
    let stored = Params {
        servo_marks: ServoMarks::S1234,
        ..Params::DEFAULT
    };
    let hands = Hands {
        vehicle: Some(Arc::new(scenario)),
        ..Hands::default()
    };
    let board = Board::with_stored(hands, stored);
    let mut builder = Builder::begins(&temp, &board, &[]);
    for step in STEPS.iter().take_while(|step| step.id != "tendon-1") {
        builder.at(&format!("({})", step.id), "s");
    }
    builder.step("tendon-1");
    builder.hears("Left out: the force is up to four times");
    builder.at("Weight in N", "3.2");
    weighed(&mut builder, &board, 1);
    builder.hears("tendon_stiffness 8000 -> ");
    builder.hears("passed");
    let first = board.stored().tendon_stiffness;
    assert!((first / 3200.0 - 1.0).abs() < 0.12, "{first}");
    // 1.5 mm are 40 us, and play and backlash of the servo 0.4 mm more.
    let trim = board.stored().servo_trim_1;
    assert!((38.0..50.0).contains(&trim), "{trim}");

    // The second is too light a weight at first, and the parameter the mean of both.
    builder.step("tendon-2");
    builder.at("Weight in N", "0.5");
    builder.hears("weight 0.5 N: allowed are 1.5 to 6 N");
    builder.at("Enter tries it again", "");
    builder.at("Enter begins", "");
    builder.at("Weight in N", "3.2");
    weighed(&mut builder, &board, 2);
    builder.hears("friction above 0.4: closings take 6 to 10 s");
    builder.hears("passed");
    let both = board.stored().tendon_stiffness;
    assert!(
        (both / 3000.0 - 1.0).abs() < 0.12 && both < first,
        "{first} {both}"
    );

    // A thread that no trim takes up is to be knotted anew.
    builder.step("tendon-3");
    builder.at("Weight in N", "");
    weighed(&mut builder, &board, 3);
    builder.hears("mm shorter, then once more");
    builder.at("Enter tries it again", "q");
    let (status, said, complaint) = builder.ends();
    assert_eq!((status, &*complaint), (Some(1), ""), "{said}");
    let file = fs::read_to_string(temp.0.join("bringup.toml")).unwrap();
    assert!(
        file.contains("servo_trim_1 = ") && file.contains("[step.measured]"),
        "{file}"
    );
    assert_eq!(board.stored().servo_trim_3, 0.0);
}

/// Rests of a thread of 4 kN/m, 1 mm of slack and a friction of 0.3, as `watch arms` shows them.
#[test]
fn steps_of_a_servo_are_fitted_from_a_table() {
    let temp = Temp::new("fit-tendon");
    let rests = [
        (0.0, 0.0),
        (0.0, 3.0),
        (0.0, 0.0),
        (63.0, 0.0),
        (80.2, 0.0),
        (97.4, 0.0),
        (97.4, 3.0),
        (97.4, 0.0),
        (114.6, 0.0),
        (131.8, 0.0),
        (131.8, 3.0),
        (131.8, 0.0),
        (131.8, 3.0),
        (131.8, 0.0),
        (114.6, 0.0),
        (97.4, 0.0),
        (80.2, 0.0),
        (63.0, 0.0),
        (0.0, 0.0),
    ];
    let given = Given {
        reel_radius: 0.015,
        lever: 0.015,
        length: 0.178,
        bend: 2.0,
        reference: 0.4,
        speed: 6.16,
    };
    let steps: Vec<Rest> = rests
        .iter()
        .map(|(reel, weight)| Rest {
            reel: f64::to_radians(*reel),
            weight: *weight,
            tilt: 0.0,
        })
        .collect();
    let truth = [-0.55, 1.5, 1.0 / 4000.0, 1e-3, 0.3, 0.01, 1.0];
    let mut table = String::from("reel_deg, weight_n, tilt_deg\n");
    for (rest, tilt) in rests.iter().zip(tilts(&steps, &[0.0; 19], &truth, &given)) {
        table += &format!("{}, {}, {:.1}\n", rest.0, rest.1, tilt.to_degrees());
    }
    temp.file("steps.csv", table.as_bytes());
    let output = sophie(&temp, &["fit-tendon", "steps.csv"]);
    assert!(output.status.success(), "{output:?}");
    let said = text(&output.stdout);
    let number = |begin: &str| {
        let line = said.lines().find_map(|line| line.strip_prefix(begin));
        let word = line.and_then(|line| line.split(' ').next());
        word.and_then(|word| word.trim_end_matches(',').parse::<f64>().ok())
            .unwrap_or_else(|| panic!("{begin}: {said}"))
    };
    assert!(
        (number("set tendon_stiffness ") / 4000.0 - 1.0).abs() < 0.1,
        "{said}"
    );
    assert!(
        (number("slack ") - 1.15).abs() < 0.3 && (number("friction ") - 0.3).abs() < 0.1,
        "{said}"
    );
    let few: String = table.lines().take(5).map(|line| format!("{line}\n")).collect();
    temp.file("few.csv", few.as_bytes());
    let line = refused(&temp, &["fit-tendon", "few.csv"]);
    assert!(
        line.contains("few.csv: 4 rests: allowed are at least 10"),
        "{line}"
    );
}
