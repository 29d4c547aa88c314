//! Baseline of the stages' cost.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Count;
use crate::{Error, build};

/// Permitted relative increase: compilers differ.
const TOLERANCE: f64 = 0.03;

#[derive(Clone, Copy, Deserialize, Serialize)]
struct Call {
    mean: f64,
    max: f64,
}

/// Core, stage, cost.
type Baseline = BTreeMap<String, BTreeMap<String, Call>>;

fn path() -> PathBuf {
    build::root().join("hil/qemu/cost/baseline.toml")
}

/// Compares with the baseline, reports decreases.
///
/// # Errors
/// Every increase, one per line.
pub fn compare(counts: &[Count]) -> Result<(), Error> {
    let baseline: Baseline = toml::from_str(&fs::read_to_string(path())?)?;
    let mut complaints = Vec::new();
    let mut cheaper = false;
    for count in counts {
        let Some(old) = baseline.get(count.core).and_then(|core| core.get(&count.stage)) else {
            complaints.push(format!("{} {}: not in the baseline", count.core, count.stage));
            continue;
        };
        for (what, new, old) in [("mean", count.mean, old.mean), ("max", count.max, old.max)] {
            let change = new / old - 1.0;
            let text = format!(
                "{} {}: {what} {new:.1}, baseline {old:.1} ({:+.1} %)",
                count.core,
                count.stage,
                100.0 * change
            );
            if change > TOLERANCE {
                complaints.push(text);
            } else if change < -0.001 {
                eprintln!("cheaper: {text}");
                cheaper = true;
            }
        }
    }
    if cheaper {
        eprintln!("`cargo xtask cost --tighten` makes this the baseline");
    }
    if complaints.is_empty() {
        Ok(())
    } else {
        Err(format!(
            "dearer by more than {:.0} %, or new; if it is meant to be, `cargo xtask cost --tighten` takes it:\n{}",
            100.0 * TOLERANCE,
            complaints.join("\n")
        )
        .into())
    }
}

/// Makes `counts` the baseline.
///
/// # Errors
/// The file cannot be written.
pub fn write(counts: &[Count]) -> Result<(), Error> {
    let mut baseline = Baseline::new();
    for count in counts {
        let tenths = |x: f64| (10.0 * x).round() / 10.0;
        let call = Call {
            mean: tenths(count.mean),
            max: count.max,
        };
        baseline
            .entry(count.core.into())
            .or_default()
            .insert(count.stage.clone(), call);
    }
    let head = "# Instructions of a call of each stage. `cargo xtask cost` compares; `--tighten` takes what is counted then.\n";
    fs::write(path(), format!("{head}\n{}", toml::to_string(&baseline)?))?;
    Ok(())
}
