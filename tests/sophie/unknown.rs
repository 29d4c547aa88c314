//! `sophie study unknown`: counts that sum to the vehicles, shards that equal the whole, and refusals in one line.

use std::fs;

use serde_json::Value;

use sophie_test_support::command::{Temp, refused, sophie, text};

const CLASSES: [&str; 5] = ["perched", "refused", "handed_back", "fallen", "not_holding"];

/// Three vehicles as built: their design check passes, so that each is flown.
const THREE: [&str; 8] = [
    "study", "unknown", "--known", "as-built", "--count", "3", "--seed", "11",
];

/// The object that the command prints, after its exit status was compared with the counts.
fn object(temp: &Temp, args: &[&str]) -> Value {
    let output = sophie(temp, args);
    let printed = text(&output.stdout);
    let object: Value = serde_json::from_str(&printed).unwrap_or_else(|_| panic!("{}", text(&output.stderr)));
    let of = |key: &str| object[key].as_u64().unwrap();
    assert_eq!(CLASSES.map(of).iter().sum::<u64>(), of("vehicles"), "{object}");
    let bad = of("fallen") + of("not_holding") > 0;
    assert_eq!(output.status.code(), Some(i32::from(bad)), "{object}");
    object
}

#[test]
fn shards_count_like_the_whole_and_a_complete_campaign_is_not_flown_again() {
    let temp = Temp::new("unknown");
    let whole = [&THREE[..], &["--json", "--out", "whole"]].concat();
    let counted = object(&temp, &whole);
    assert_eq!(counted["vehicles"], 3);
    assert_eq!(counted["command"]["known"], "as-built");
    let rows = temp.0.join("whole/unknown-1-of-1.csv");
    let table = fs::read_to_string(&rows).unwrap();
    assert_eq!(table.lines().count(), 4);
    assert!(temp.0.join("whole/unknown.html").exists() && temp.0.join("whole/unknown.json").exists());
    let written = fs::metadata(&rows).unwrap().modified().unwrap();
    assert_eq!(object(&temp, &whole), counted);
    assert_eq!(fs::metadata(&rows).unwrap().modified().unwrap(), written);

    let shard = |which: &str| {
        let output = sophie(
            &temp,
            &[&THREE[..], &["--shard", which, "--out", "shards"]].concat(),
        );
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    };
    shard("2/2");
    let missing = sophie(&temp, &["study", "unknown", "--missing", "shards"]);
    assert_eq!(
        (missing.status.code(), text(&missing.stdout).as_str()),
        (Some(0), "1\n")
    );
    let line = refused(&temp, &["study", "unknown", "--summarise", "shards"]);
    assert!(line.ends_with("shards 1 of 2 are missing"), "{line}");
    shard("1/2");
    let none = sophie(&temp, &["study", "unknown", "--missing", "shards"]);
    assert!(none.status.success() && none.stdout.is_empty());
    assert_eq!(
        object(&temp, &["study", "unknown", "--summarise", "shards", "--json"]),
        counted
    );

    let line = refused(
        &temp,
        &[
            "study", "unknown", "--count", "3", "--seed", "11", "--out", "shards",
        ],
    );
    assert!(
        line.contains("rows of another command: known as-built, here calibrated"),
        "{line}"
    );
}

#[test]
fn bad_input_is_refused_in_one_line() {
    let temp = Temp::new("unknown-options");
    fs::create_dir(temp.0.join("empty")).unwrap();
    temp.file("unknown-1-of-1.csv", b"a,b\n1,2\n");
    for (args, message) in [
        (&["--count", "0"][..], "allowed 1 to 100000"),
        (&["--shard", "0/4"], "allowed I/N with I from 1 to N"),
        (&["--shard", "5/4"], "allowed I/N with I from 1 to N"),
        (&["--shard", "-1/4"], "allowed I/N with I from 1 to N"),
        (&["--shard", "2"], "allowed I/N with I from 1 to N"),
        (
            &["--shard", "2/4", "--count", "3"],
            "as many shares as vehicles, here 3",
        ),
        (&["--wind", "-1"], "allowed 0 to 15 m/s"),
        (&["--wind", "nan"], "allowed 0 to 15 m/s"),
        (&["--known", "guessed"], "allowed exact, calibrated, as-built"),
        (&["--assist", "hold"], "allowed none, self"),
        (&["--sensors", "gps"], "allowed none, pose, flow"),
        (&["--seed", "9e15", "--count", "2"], "the last of 2 vehicles"),
        (&["--missing", "nowhere"], "--missing nowhere: cannot be read"),
        (&["--missing", "empty"], "--missing empty: no file of a shard"),
        (&["--summarise", "empty"], "--summarise empty: no file of a shard"),
        (
            &["--summarise", "."],
            "unknown-1-of-1.csv:1: its columns are not those",
        ),
        (&["--summarise", ".", "--count", "3"], "cannot be used with"),
        (&["--summarise", ".", "--missing", "."], "cannot be used with"),
        (&["vehicles.toml"], "allowed is one study and no file"),
    ] {
        let line = refused(&temp, &[&["study", "unknown"], args].concat());
        assert!(line.contains(message), "{args:?}: {line}");
    }
}
