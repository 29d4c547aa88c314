//! Flies every scenario file; the flight must end as its `[expect]` says.

use std::error::Error;
use std::path::Path;

use libtest_mimic::{Arguments, Failed, Trial};
use sophie_sim::flight::fly;
use sophie_sim::record::{FlightRecord, Silent};
use sophie_sim::scenario::{Expect, Overrides, Scenario};
use sophie_test_support::flights;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = Arguments::from_args();
    let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenarios");
    let mut files = Vec::new();
    for entry in std::fs::read_dir(directory)? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "toml") {
            files.push(path);
        }
    }
    files.sort();
    if files.is_empty() {
        return Err("no scenario files found".into());
    }
    let trials = files.into_iter().map(|path| {
        let name = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        Trial::test(name, move || flown_as_expected(&path))
    });
    libtest_mimic::run(&arguments, trials.collect()).exit()
}

fn flown_as_expected(path: &Path) -> Result<(), Failed> {
    let scenario = Scenario::load(path, &Overrides::default())?;
    let record = fly(&scenario, &mut Silent);
    judge(&scenario.expect, &record)?;
    // Deadlines hold in virtual time.
    if record.overruns > 0 {
        return Err(format!("{} deadlines missed", record.overruns).into());
    }
    Ok(())
}

fn judge(expect: &Expect, record: &FlightRecord) -> Result<(), Failed> {
    let outcome = &record.outcome;
    if let Some(words) = &expect.says
        && !record.events.iter().any(|event| event.text.contains(words))
    {
        return Err(format!("the pilot did not read \"{words}\": {}", outcome.reason).into());
    }
    if outcome.accomplished != expect.accomplished {
        let wanted = if expect.accomplished {
            "accomplished"
        } else {
            "not accomplished"
        };
        return Err(format!("expected {wanted}, got: {}", outcome.reason).into());
    }
    if !outcome.accomplished {
        let words = expect.reason.as_deref().unwrap_or_default();
        if !outcome.reason.contains(words) {
            return Err(format!("expected a reason with \"{words}\", got: {}", outcome.reason).into());
        }
        return Ok(());
    }
    let undone: Vec<&str> = record
        .phases
        .iter()
        .filter(|p| !p.done)
        .map(|p| p.name.as_str())
        .collect();
    if !undone.is_empty() {
        return Err(format!("accomplished, but not done: {}", undone.join(", ")).into());
    }
    flights::proven(record)?;
    Ok(())
}
