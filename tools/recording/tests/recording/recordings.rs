//! What others have recorded, and what this stack makes of it: docs/tests.md says where the files are from.
//!
//! They are data of others and not part of the tree: `SOPHIE_RECORDINGS` is the folder with them. Without it the tests are
//! skipped, and say so.

use std::path::PathBuf;

use flate2::read::GzDecoder;
use sophie_clock as _;
use sophie_control::params::Params;
use sophie_recording::bytes::{Protocol, decode};
use sophie_recording::replay::{Named, Options, Outcome, replay};
use sophie_recording::truth::Truth;

const FOLDER: &str = "SOPHIE_RECORDINGS";

/// The file of this name; `None` where there are none.
fn recording(name: &str) -> Option<PathBuf> {
    let Some(folder) = std::env::var_os(FOLDER) else {
        println!("skipped: {FOLDER} is not set, the folder with {name}");
        return None;
    };
    let path = PathBuf::from(folder).join(name);
    if !path.exists() {
        println!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path)
}

fn run(path: &std::path::Path, from_s: f64, truth: Option<Truth>) -> Outcome {
    let options = Options {
        params: Params::default(),
        from_s,
    };
    replay(path, &options, truth).unwrap()
}

#[test]
fn a_flight_over_a_carpet_is_estimated_without_a_fault() {
    let files = ["flight_carpet-01.replay.csv.gz", "flight_carpet-01.truth.csv.gz"].map(recording);
    let [Some(path), Some(truth)] = files else {
        return;
    };
    let out = run(&path, 0.0, Some(Truth::read(&truth).unwrap()));
    let errors = out.errors.as_ref().unwrap();
    assert!(out.estimate_share > 0.98, "{}", out.estimate_share);
    assert_eq!(out.faults, []);
    assert!(errors.velocity().unwrap() < 0.04, "{:?}", errors.velocity());
    assert!(errors.height().unwrap() < 0.01, "{:?}", errors.height());
    assert!(errors.place_end().unwrap() < 0.3, "{:?}", errors.place_end());
    let ([roll, pitch], _) = errors.attitude().unwrap();
    assert!(roll < 1.0 && pitch < 1.0, "{roll} {pitch}");
}

#[test]
fn flow_that_begins_in_the_air_over_a_carpet_is_not_named() {
    let Some(path) = recording("flight_carpet-01.replay.csv.gz") else {
        return;
    };
    let begins = (6..60).map(f64::from);
    let named: Vec<(f64, Vec<Named>)> = begins
        .map(|from| (from, run(&path, from, None).faults))
        .filter(|(from, faults)| faults.iter().any(|fault| fault.from_s < from + 5.0))
        .collect();
    // At 22 s 0.05 s of it: the flow of this part is noisier than is assumed.
    assert!(named.len() <= 1, "{named:?}");
}

/// The ranges of a recording in whole centimetres, the last one sent again and again.
#[test]
fn real_ranges_in_centimetres_sent_again_are_not_frozen() {
    let Some(path) = recording("flight_carpet-01.replay.csv.gz") else {
        return;
    };
    let mut text = String::new();
    let file = std::fs::File::open(&path).unwrap();
    std::io::Read::read_to_string(&mut GzDecoder::new(file), &mut text).unwrap();
    for hz in [24, 50, 100] {
        let mut out = String::new();
        let (mut last, mut sent): (Option<f64>, u64) = (None, 0);
        for line in text.lines() {
            let cells: Vec<&str> = line.split(',').collect();
            let at: u64 = cells[1].parse().unwrap();
            if cells[0] == "R" {
                let distance: f64 = cells[3].parse().unwrap();
                last = Some((distance * 100.0).round() / 100.0).filter(|d| d.is_finite());
                if hz != 24 {
                    continue;
                }
            }
            let due = hz == 24 && cells[0] == "R" || hz != 24 && at / (1_000_000 / hz) > sent;
            if due {
                sent = at / (1_000_000 / hz);
                let range = last.map_or("nan".to_owned(), |d| format!("{d:.2}"));
                out += &format!("R,{at},{},{range},0.02,8.0\n", at - 25_000);
            }
            if cells[0] != "R" {
                out += line;
                out.push('\n');
            }
        }
        let copy = std::env::temp_dir().join(format!("sophie-cm-{hz}-{}.csv", std::process::id()));
        std::fs::write(&copy, out).unwrap();
        let found = run(&copy, 0.0, None);
        std::fs::remove_file(&copy).unwrap();
        let frozen: Vec<&Named> = found
            .faults
            .iter()
            .filter(|f| f.name.contains("frozen"))
            .collect();
        println!("{hz} Hz: {:?}, {:.3}", found.faults, found.estimate_share);
        assert!(frozen.is_empty(), "{hz} Hz: {frozen:?}");
        assert!(found.estimate_share > 0.98, "{hz} Hz: {}", found.estimate_share);
    }
}

#[test]
fn flow_over_a_shiny_floor_is_named() {
    let Some(path) = recording("move_floor-00.replay.csv.gz") else {
        return;
    };
    let out = run(&path, 0.0, None);
    let began = out.estimate_s.unwrap();
    let named: Vec<&Named> = out
        .faults
        .iter()
        .filter(|f| f.name == "flow mirrored or scaled")
        .collect();
    assert!(
        named.first().is_some_and(|f| f.from_s < began + 1.5),
        "{began} {named:?}"
    );
    let time: f64 = named.iter().map(|f| f.to_s - f.from_s).sum();
    assert!(time > 55.0, "{time} {named:?}");
}

#[test]
fn an_attitude_is_calibrated_and_runs_through() {
    let Some(path) = recording("attitude-log33.replay.csv.gz") else {
        return;
    };
    let out = run(&path, 0.0, None);
    let after = out.calibrated_s.map(|s| s - 26.85);
    assert!(after.is_some_and(|s| (1.99..2.1).contains(&s)), "{after:?}");
    assert_eq!((out.faults, out.gaps), (vec![], 0));
}

#[test]
fn every_frame_of_a_receiver_with_telemetry_is_found() {
    let Some(path) = recording("sbus2-r7008sb.txt") else {
        return;
    };
    let out = decode(&path, Protocol::Sbus, &Params::default()).unwrap();
    assert!(out.frames >= 31 && out.longest_pause_ms < 61.0, "{out:?}");
}
