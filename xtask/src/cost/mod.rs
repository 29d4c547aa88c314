//! Instructions of every stage of the control path, counted under QEMU.

mod baseline;
mod cycles;
mod instruction;
mod qemu;
mod stages;
mod table;

use serde::Serialize;

use crate::build::Recipe;
use crate::{Error, build};

/// The cores that the boards have.
pub const CORES: [Core; 2] = [
    Core {
        name: "M4F",
        cpu: "cortex-m4",
        machine: "mps2-an386",
    },
    Core {
        name: "M7",
        cpu: "cortex-m7",
        machine: "mps2-an500",
    },
];

/// A core, and where QEMU has one.
pub struct Core {
    /// Name in tables.
    pub name: &'static str,
    /// Name for the compiler.
    pub cpu: &'static str,
    /// QEMU's machine with this core.
    pub machine: &'static str,
}

/// What to do with the counts.
#[derive(Clone, Copy, PartialEq)]
pub enum Then {
    /// Print them as a table and compare with the baseline.
    Compare,
    /// The same, printed as JSON.
    Json,
    /// Print them and make them the baseline.
    Tighten,
    /// Print the cycles that an M4F takes at least and at most, instead.
    Cycles,
}

/// Counts of one stage on one core; instructions.
#[derive(Clone, Serialize)]
pub struct Count {
    /// Name of the stage.
    pub stage: String,
    /// Name of the core.
    pub core: &'static str,
    /// Calls counted.
    pub calls: u64,
    /// Mean of a call.
    pub mean: f64,
    /// Cheapest call.
    pub min: f64,
    /// Dearest call.
    pub max: f64,
}

/// Builds and runs the image of each core, then does as `then` says.
///
/// # Errors
/// No toolchain or no QEMU, the cores disagree on the motor commands, or a stage has become dearer.
pub fn cost(then: Then) -> Result<(), Error> {
    if then == Then::Cycles {
        return cycles::cycles();
    }
    let mut counts = Vec::new();
    let mut commands = Vec::new();
    for core in &CORES {
        let elf = build::image(&Recipe {
            package: "sophie-cost",
            arguments: &[],
            variables: &[],
            core: core.cpu,
            kept: core.cpu,
        })?;
        let run = qemu::run(core, &elf)?;
        counts.extend(run.counts);
        commands.extend(run.commands);
    }
    // Stage by stage or at one go, on either core: the same bits, or something else was counted.
    if commands.windows(2).any(|pair| pair.first() != pair.last()) {
        return Err(format!("the motor commands differ: {}", commands.join(", ")).into());
    }
    if then == Then::Json {
        println!("{}", serde_json::to_string_pretty(&table::rows(&counts))?);
    } else {
        print!("{}", table::markdown(&counts));
    }
    if then == Then::Tighten {
        baseline::write(&counts)?;
        table::write(&counts)
    } else {
        baseline::compare(&counts)
    }
}
