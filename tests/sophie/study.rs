//! `sophie study vehicles`: the same family for the same seed, scenarios that fly again alike, refusals in one line.

use std::fs;

use serde_json::Value;

use sophie_test_support::command::{Temp, refused, sophie, text};

#[test]
fn each_vehicle_is_counted_once_and_its_scenario_flies_again_to_the_same_end() {
    let temp = Temp::new("study");
    let args = [
        "study", "vehicles", "--count", "3", "--seed", "5", "--json", "--out", "family",
    ];
    let output = sophie(&temp, &args);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let family: Value = serde_json::from_str(&printed).unwrap();
    let flown = family["flown"].as_array().unwrap();
    assert_eq!((family["vehicles"].as_u64(), flown.len()), (Some(3), 3));
    let accomplished = flown.iter().filter(|v| v["accomplished"] == true).count() as u64;
    assert_eq!(family["accomplished"].as_u64(), Some(accomplished));
    let failed: u64 = family["causes"]
        .as_object()
        .unwrap()
        .values()
        .map(|n| n.as_u64().unwrap())
        .sum();
    assert_eq!(accomplished + failed, 3, "{family}");
    assert!(
        fs::read_to_string(temp.0.join("family/vehicles.html"))
            .unwrap()
            .contains("<svg")
    );
    assert_eq!(
        fs::read_to_string(temp.0.join("family/vehicles.json"))
            .unwrap()
            .trim_end(),
        printed.trim_end()
    );

    let one = &flown[1];
    assert_eq!(one["seed"].as_u64(), Some(6));
    fs::write(temp.0.join("six.toml"), one["scenario"].as_str().unwrap()).unwrap();
    let again = sophie(&temp, &["fly", "six.toml", "--json", "--out", "again"]);
    let summary: Value = serde_json::from_str(&text(&again.stdout)).unwrap();
    assert_eq!(summary["accomplished"], one["accomplished"]);
    assert_eq!(summary["reason"], one["reason"]);
}

#[test]
fn options_out_of_range_are_refused_in_one_line() {
    let temp = Temp::new("study-options");
    for (args, message) in [
        (&["vehicles", "--count", "0"][..], "allowed 1 to 100000"),
        (&["vehicles", "--spread", "1.1"], "allowed 0 to 1"),
        (&["vehicles", "--spread", "nan"], "allowed 0 to 1"),
        (&["vehicles", "--seed", "-1"], "a whole number from 0"),
        (&["birds"], "no study 'birds': allowed are vehicles, unknown"),
        (&[], "<STUDY> is missing: allowed are vehicles, unknown"),
        (&["vehicles", "v.toml"], "allowed is one study and no file"),
    ] {
        let line = refused(&temp, &[&["study"], args].concat());
        assert!(line.contains(message), "{args:?}: {line}");
    }
}
