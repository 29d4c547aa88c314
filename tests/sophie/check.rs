//! `sophie check`, and `sophie fly` for a vehicle that fails it.

use std::time::{Duration, Instant};

use serde_json::Value;

use sophie_test_support::command::{Temp, command, refused, sophie, text};

/// Explains rows and JSON fields.
const DOCS: &str = include_str!("../../docs/design-check.md");

fn json(temp: &Temp, args: &[&str]) -> (Option<i32>, Value) {
    let output = sophie(temp, args);
    let value = serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{args:?}: {e}"));
    (output.status.code(), value)
}

fn failing(check: &Value) -> Vec<&str> {
    let rows = check["rows"].as_array().unwrap().iter();
    let failing = rows.filter(|row| row["pass"] == false);
    failing.map(|row| row["name"].as_str().unwrap()).collect()
}

#[test]
fn the_default_vehicle_can_fly_and_is_told_so_at_once() {
    let temp = Temp::new("check-default");
    let start = Instant::now();
    let output = command(&temp.0, &["check"]).output().unwrap();
    let took = start.elapsed();
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(
        output.stderr.is_empty() && said.trim_end().ends_with("can fly"),
        "{said}"
    );
    assert!(took < Duration::from_secs(3), "{took:?}");
    assert!(!temp.0.join("out").exists());
}

#[test]
fn the_json_is_one_object_and_every_field_and_row_is_in_the_document() {
    let temp = Temp::new("check-fields");
    let (status, check) = json(&temp, &["check", "--json"]);
    assert_eq!((status, &check["can_fly"]), (Some(0), &true.into()));
    let row = check["rows"][0].as_object().unwrap();
    for field in check.as_object().unwrap().keys().chain(row.keys()) {
        assert!(DOCS.contains(&format!("`{field}`")), "{field}");
    }
    for row in check["rows"].as_array().unwrap() {
        assert!(
            row["value"].is_number() && row["limit"].is_number() && row["advice"].is_null(),
            "{row}"
        );
        let name = row["name"].as_str().unwrap().split(" arm ").next().unwrap();
        let any_axis = ["roll ", "pitch ", "yaw "]
            .iter()
            .any(|axis| DOCS.contains(name.trim_start_matches(axis)));
        assert!(DOCS.contains(name) || any_axis, "{name}");
    }
}

#[test]
fn fly_s_options_choose_the_vehicle() {
    let temp = Temp::new("check-options");
    let thin = temp.file("thin.toml", b"[world]\npipe_diameter_m = 0.2\n");
    let options = ["--rho", "8", "--gain-k", "3.5", "--arms", "2", "--json"];
    let (status, check) = json(&temp, &[&["check", &thin], &options[..]].concat());
    assert_eq!(status, Some(1));
    assert_eq!(failing(&check), ["grip force arm 1", "grip force arm 3"]);
    let (status, check) = json(&temp, &["check", "--config", "A", "--mixer", "rigid", "--json"]);
    assert!(
        status == Some(1) && failing(&check).contains(&"yaw derivative"),
        "{check}"
    );
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let temp = Temp::new("check-bad");
    let bad = temp.file("bad.toml", b"[vehicle]\ninfill = 3.5");
    let line = refused(&temp, &["check", &bad]);
    assert_eq!(
        line,
        format!("sophie: {bad}:2: vehicle.infill = 3.5: allowed 4 to 10 %")
    );
    for args in [
        &["check", "--infill", "3.5"][..],
        &["check", "--out", "x"],
        &["check", "one.toml", "two.toml"],
        &["check", "missing.toml"],
    ] {
        refused(&temp, args);
    }
}

/// Requires that stderr before the flight and its reason name the rows.
fn flown_in_vain(name: &str, scenario: &str, words: &[&str]) {
    let temp = Temp::new(name);
    let file = temp.file("vehicle.toml", scenario.as_bytes());
    let (status, check) = json(&temp, &["check", &file, "--json"]);
    assert!(status == Some(1) && check["can_fly"] == false, "{check}");
    let output = sophie(&temp, &["fly", &file]);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    let (before, last) = said.trim_end().rsplit_once('\n').unwrap();
    assert!(last.starts_with("sophie: not accomplished: "), "{last}");
    for word in words {
        assert!(
            before.contains(&format!("sophie: check: {word}")),
            "{word}: {before}"
        );
        assert!(last.contains(&format!("check: {word}")), "{word}: {last}");
    }
    assert_eq!(before.lines().count(), failing(&check).len(), "{before}");
}

#[test]
fn a_vehicle_too_heavy_for_its_rotors() {
    flown_in_vain(
        "check-heavy",
        "[vehicle]\nmass_kg = 3\nthrust_max_n = 7.6\n",
        &["thrust to weight 1.0"],
    );
}

#[test]
fn rotors_of_5_newtons_do_not_outlast_the_battery() {
    let scenario = "steps = [{ do = 'arm' }, { do = 'take-off', height_m = 2 }, { do = 'hover', seconds = 200 }, \
                    { do = 'land' }, { do = 'disarm' }]\ntime_limit_s = 200\n\
                    [vehicle]\nthrust_max_n = 5\nbattery_charge_percent = 10\n";
    flown_in_vain("check-weak", scenario, &["thrust to weight 1.1"]);
}

#[test]
fn arms_too_stiff_for_a_thin_pipe() {
    let scenario = "[vehicle]\ninfill = 8\ngain_k = 3.5\n[world]\npipe_diameter_m = 0.2\n";
    flown_in_vain("check-stiff", scenario, &["grip force arm 1", "grip force arm 4"]);
}

#[test]
fn a_gain_that_oscillates() {
    flown_in_vain(
        "check-gain",
        "[params]\nrate_pitch_p = 30\n",
        &["pitch gain margin 0.8", "pitch phase margin"],
    );
}
