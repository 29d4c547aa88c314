//! `sophie fit-thrust`: parameters from a table of scale readings that a person has written.

use std::fmt::Write;

use sophie_control::pilot::static_thrust_test::Rotors;
use sophie_sim::scenario::{Overrides, Scenario};
use sophie_sim::streams::Streams;
use sophie_sim::test_stands::thrust_stand::ThrustStand;
use sophie_test_support::command::{Temp, refused, sophie, text};

const VEHICLE: &str =
    "[vehicle]\nthrust_max_n = 7.4\nrotor_thrust = [0.97, 1.02, 1.03, 0.98]\nthrust_voltage_power = 1.8\n";

/// Readings of a simulated vehicle on a scale, with a fresh and a used battery.
fn table() -> String {
    let scenario = Scenario::parse(VEHICLE, "weak", &Overrides::default()).unwrap();
    let mut stand = ThrustStand::new(&scenario, Streams::new(9));
    let mut text = "command_percent,voltage_v,rotor,reading_g,tilt_deg # by hand\n".to_owned();
    for (charge, alone) in [(1.0, true), (0.35, false)] {
        stand.change_battery(&scenario, charge);
        let together = [45, 55, 70, 85, 100].map(|percent| (Rotors::All, percent));
        let each = (0..4).flat_map(|rotor| [55, 85].map(|percent| (Rotors::One(rotor), percent)));
        for (rotors, percent) in together.into_iter().chain(each.filter(|_| alone)) {
            let read = stand.run(rotors, f64::from(percent) * 0.01);
            stand.rest(20.0);
            let (number, tilt) = match rotors {
                Rotors::All => (0, read.tilt.iter().sum::<f64>() / 4.0),
                Rotors::One(rotor) => (rotor + 1, read.tilt[rotor]),
            };
            writeln!(
                text,
                "{percent},{:.2},{number},{:.0},{:.1}",
                read.voltage,
                read.grams,
                tilt.to_degrees()
            )
            .unwrap();
        }
    }
    text
}

#[test]
fn a_table_gives_the_parameters_as_lines_for_the_console() {
    let temp = Temp::new("fit-thrust");
    temp.file("readings.csv", table().as_bytes());
    let output = sophie(&temp, &["fit-thrust", "readings.csv"]);
    let said = text(&output.stdout);
    assert_eq!(
        (output.status.code(), text(&output.stderr).as_str()),
        (Some(0), ""),
        "{said}"
    );
    let set = |name: &str| -> f64 {
        let line = said
            .lines()
            .find_map(|line| line.strip_prefix(&format!("set {name} ")));
        line.unwrap_or_else(|| panic!("{name}: {said}")).parse().unwrap()
    };
    for (name, truth, share) in [
        ("thrust_max", 7.4, 0.025),
        ("thrust_volt_exp", 1.8, 0.08),
        ("thrust_trim_1", 0.97, 0.02),
        ("thrust_trim_2", 1.02, 0.02),
        ("thrust_trim_3", 1.03, 0.02),
        ("thrust_trim_4", 0.98, 0.02),
    ] {
        assert!((set(name) / truth - 1.0).abs() < share, "{name}: {said}");
    }
    assert!((0.5..1.0).contains(&set("thrust_curve")), "{said}");
    assert!(said.ends_with("\nsave\n"), "{said}");
    assert!(said.contains("thrust_max") && said.contains(" +- "), "{said}");
}

#[test]
fn what_one_battery_and_four_rotors_together_do_not_tell_is_said() {
    let temp = Temp::new("fit-thrust-few");
    let few: String = table().lines().take(6).map(|line| format!("{line}\n")).collect();
    temp.file("few.csv", few.as_bytes());
    let output = sophie(&temp, &["fit-thrust", "few.csv"]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        said.contains("thrust_volt_exp: not told") && !said.contains("set thrust_volt_exp"),
        "{said}"
    );
    assert!(
        said.contains("thrust_trim_1 to _4: not told") && !said.contains("set thrust_trim"),
        "{said}"
    );
}

#[test]
fn a_mistyped_reading_warns_and_a_bad_table_is_refused_in_one_line() {
    let temp = Temp::new("fit-thrust-bad");
    // The third reading, all rotors at 70 %, with a digit too many taken off.
    let odd: Vec<String> = table()
        .lines()
        .enumerate()
        .map(|(i, line)| {
            let mut cells: Vec<&str> = line.split(',').collect();
            if i == 3 {
                cells[3] = "1200";
            }
            cells.join(",")
        })
        .collect();
    temp.file("odd.csv", odd.join("\n").as_bytes());
    let output = sophie(&temp, &["fit-thrust", "odd.csv"]);
    let complaint = text(&output.stderr);
    assert_eq!(output.status.code(), Some(0));
    assert!(complaint.contains("warning: odd.csv: row 3: -"), "{complaint}");
    for (name, rows, why) in [
        ("none.csv", "", "none.csv:1: no row stands below the header"),
        (
            "narrow.csv",
            "70,15,1200\n75,15,1400\n80,15,1500\n",
            "narrow.csv: 3 commands from 70 to 80 %: allowed are 3 at least, over 30 %",
        ),
        (
            "volts.csv",
            "70,1.5,1200\n",
            "volts.csv:2: voltage_v = '1.5': allowed is a number from 5 to 60 V",
        ),
        (
            "strong.csv",
            "40,15,60000\n",
            "strong.csv:2: reading_g = '60000': allowed is a number from 1 to 20000 g",
        ),
        (
            "weak.csv",
            "40,15,20\n60,15,40\n100,15,100\n",
            "weak.csv: thrust_max = 0.2",
        ),
    ] {
        temp.file(
            name,
            format!("command_percent,voltage_v,reading_g\n{rows}").as_bytes(),
        );
        let line = refused(&temp, &["fit-thrust", name]);
        assert!(line.contains(why), "{name}: {line}");
    }
    let line = refused(&temp, &["fit-thrust", "odd.csv", "--nominal", "3"]);
    assert!(line.contains("allowed 6 to 52 V"), "{line}");
}
