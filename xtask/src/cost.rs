//! Instructions of every stage of the control path, counted under QEMU.

mod baseline;
mod cycles;
mod instruction;
mod qemu;
mod stages;
mod table;

use std::path::PathBuf;

use serde::Serialize;

use crate::build::Recipe;
use crate::{Error, build};

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

pub struct Core {
    /// Name in tables.
    pub name: &'static str,
    /// The compiler's name.
    pub cpu: &'static str,
    /// QEMU machine with this core.
    pub machine: &'static str,
}

impl Core {
    /// Builds the counting image for it; its path.
    fn image(&self) -> Result<PathBuf, Error> {
        build::image(&Recipe {
            package: "sophie-cost",
            arguments: &[],
            variables: &[],
            core: self.cpu,
            kept: self.cpu,
        })
    }
}

#[derive(Clone, Copy, PartialEq)]
pub enum Then {
    /// Print a table and compare with the baseline.
    Compare,
    /// The same as JSON.
    Json,
    /// Print them and make them the baseline.
    Tighten,
    /// Print bounds of an M4F's cycles instead.
    Cycles,
}

/// Instructions of one stage on one core.
#[derive(Clone, Serialize)]
pub struct Count {
    pub stage: String,
    pub core: &'static str,
    pub calls: u64,
    pub mean: f64,
    pub min: f64,
    pub max: f64,
}

/// Builds and runs the image of each core, then acts as in `then`.
///
/// # Errors
/// No toolchain or QEMU, different motor commands, or a costlier stage.
pub fn cost(then: Then) -> Result<(), Error> {
    if then == Then::Cycles {
        return cycles::cycles();
    }
    let mut counts = Vec::new();
    let mut commands = Vec::new();
    for core in &CORES {
        let elf = core.image()?;
        let run = qemu::run(core, &elf)?;
        counts.extend(run.counts);
        commands.extend(run.commands);
    }
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
