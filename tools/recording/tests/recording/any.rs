//! Lines of any kind: refused in a line, or run to the end with numbers that make sense.

use std::fmt::Write as _;

use proptest::prelude::*;
use sophie_clock as _;
use sophie_control::params::Params;
use sophie_recording::bytes::{Protocol, decode};
use sophie_recording::replay::{Options, replay};
use sophie_recording::truth::Truth;

fn cell() -> impl Strategy<Value = String> {
    prop_oneof![
        4 => (-1.0f32..1.0).prop_map(|x| x.to_string()),
        2 => any::<f32>().prop_map(|x| x.to_string()),
        1 => "[ -~]{0,6}",
    ]
}

/// A time since the line before, µs, a letter and what follows it.
fn line() -> impl Strategy<Value = (u64, char, Vec<String>)> {
    let letter =
        prop_oneof![8 => Just('I'), 2 => Just('F'), 2 => Just('R'), 1 => Just('L'), 1 => any::<char>()];
    let since = prop_oneof![8 => 900u64..1100, 1 => 0u64..200_000, 1 => any::<u64>()];
    (since, letter, prop::collection::vec(cell(), 0..8))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn lines_of_any_kind_are_refused_or_run(lines in prop::collection::vec(line(), 0..60), sound in any::<bool>()) {
        let mut text = String::new();
        let mut at = 1_000_000u64;
        for i in 0..5 {
            writeln!(text, "I,{},0,0,0,0,0,-9.8", at - 5_000 + 1_000 * i).unwrap();
        }
        for (since, letter, cells) in lines {
            at = at.saturating_add(since);
            // Half of the cases are of sound samples with odd times.
            if sound {
                writeln!(text, "I,{at},0.1,0,0,0,0,-9.8").unwrap();
            } else {
                writeln!(text, "{letter},{at},{}", cells.join(",")).unwrap();
            }
        }
        let path = std::env::temp_dir().join(format!("sophie-any-{}.csv", std::process::id()));
        std::fs::write(&path, text).unwrap();
        let options = Options { params: Params::default(), from_s: 0.0 };
        let found = replay(&path, &options, None);
        let truth = Truth::read(&path);
        let bytes = decode(&path, Protocol::Msp, &options.params);
        std::fs::remove_file(&path).unwrap();
        prop_assert!(truth.is_err() && bytes.is_err());
        match found {
            Ok(out) => {
                prop_assert!((0.0..=1.0).contains(&out.estimate_share) && out.seconds.is_finite());
                prop_assert!(out.faults.iter().all(|f| f.from_s <= f.to_s && f.to_s <= out.seconds));
            }
            Err(line) => prop_assert!(line.lines().count() == 1 && line.contains(".csv"), "{}", line),
        }
    }
}
