//! `sophie capture`: counts that add up, the same for the same seed, and refusals in one line.

use std::fs;

use serde_json::Value;

use sophie_test_support::command::{Temp, refused, sophie, text};

/// Enough for one careful touch on each pipe, and some from anywhere.
const SMALL: [&str; 5] = ["capture", "--touches", "20", "--seed", "1"];

#[test]
fn every_touch_is_counted_once_and_the_same_seed_gives_the_same_map() {
    let temp = Temp::new("capture");
    let run = |out: &str| {
        let args = [&SMALL[..], &["--json", "--out", out]].concat();
        let output = sophie(&temp, &args);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout)
    };
    let printed = run("first");
    let map: Value = serde_json::from_str(&printed).unwrap();
    let of = |key: &str| map[key].as_u64().unwrap();
    assert_eq!(of("touches"), 20);
    assert_eq!(
        of("held") + of("refused") + of("flown_away") + of("lost"),
        20,
        "{map}"
    );
    assert!(
        of("held") > 0 && of("refused") > 0 && of("released") <= of("held"),
        "{map}"
    );
    for key in ["half_width_held_m", "half_width_releasable_m"] {
        assert!((0.0..0.09).contains(&map[key].as_f64().unwrap()), "{key}: {map}");
    }
    assert_eq!(map["pipes"].as_array().unwrap().len(), 4);
    assert_eq!(printed, run("second"));
    let page = fs::read_to_string(temp.0.join("first/capture.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("held and let go"));
    assert_eq!(
        fs::read_to_string(temp.0.join("first/capture.json"))
            .unwrap()
            .trim_end(),
        printed.trim_end()
    );
}

#[test]
fn uncertain_vehicles_meet_the_same_touches_otherwise() {
    let temp = Temp::new("capture-uncertain");
    let run = |args: &[&str]| -> Value {
        let output = sophie(&temp, &[&SMALL[..], &["--json"], args].concat());
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        serde_json::from_str(&text(&output.stdout)).unwrap()
    };
    let (alike, drawn) = (run(&[]), run(&["--uncertain"]));
    assert_eq!(
        (&alike["uncertain"], &drawn["uncertain"]),
        (&false.into(), &true.into())
    );
    assert_eq!(drawn["touches"], 20);
    // The largest pressure of a proven grip near the crown, and whose it is: of another touch, or of another value.
    for map in [&alike, &drawn] {
        let pressure = map["near_closing_pressure_pa"].as_f64().unwrap();
        assert!((950.0..1300.0).contains(&pressure), "{map}");
        assert!(
            (1..=20).contains(&map["near_closing_seed"].as_u64().unwrap())
                && (1..=20).contains(&map["deepest_seed"].as_u64().unwrap()),
            "{map}"
        );
    }
    assert_ne!(
        alike["near_closing_pressure_pa"],
        drawn["near_closing_pressure_pa"]
    );
}

#[test]
fn options_out_of_range_are_refused_in_one_line() {
    let temp = Temp::new("capture-options");
    for (args, message) in [
        (&["--touches", "9"][..], "allowed 10 to 1000000"),
        (&["--touches", "many"], "allowed 10 to 1000000"),
        (&["--seed", "-1"], "a whole number from 0"),
        (&["--heading", "46"], "allowed 0 to 45 degrees"),
        (&["--heading", "nan"], "allowed 0 to 45 degrees"),
        (&["pipe.toml"], "allowed is no file"),
    ] {
        let line = refused(&temp, &[&["capture"], args].concat());
        assert!(line.contains(message), "{args:?}: {line}");
    }
}
