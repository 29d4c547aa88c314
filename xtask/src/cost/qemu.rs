//! Runs the counting image and reads its output.

use std::path::Path;
use std::process::{Child, Command, Stdio};

use super::{Core, Count};
use crate::{Error, build};

pub struct Run {
    pub counts: Vec<Count>,
    /// Digests of the motor commands: by stage, and whole.
    pub commands: Vec<String>,
}

pub fn command(core: &Core, elf: &Path) -> Command {
    let mut command = Command::new("qemu-system-arm");
    // An instruction lasts 2^7 ns, some ticks of the timer with which the image counts.
    command.args(["-machine", core.machine, "-nographic", "-icount", "shift=7"]);
    command.args(["-semihosting-config", "enable=on,target=native", "-kernel"]);
    command.arg(elf).stdin(Stdio::null());
    command
}

/// Starts QEMU.
///
/// # Errors
/// It is not installed, or does not start.
pub fn started(command: &mut Command) -> Result<Child, Error> {
    let started = command.spawn();
    started.map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => {
            "qemu-system-arm is not installed (Debian, Ubuntu: apt-get install qemu-system-arm)".into()
        }
        _ => e.into(),
    })
}

/// Runs `elf` on `core`.
///
/// # Errors
/// No QEMU, or the image failed.
pub fn run(core: &Core, elf: &Path) -> Result<Run, Error> {
    let mut command = command(core, elf);
    command.stdout(Stdio::piped()).stderr(Stdio::inherit());
    eprintln!("{}", build::shown(&command));
    let output = started(&mut command)?.wait_with_output()?;
    let text = String::from_utf8(output.stdout)?;
    if !output.status.success() {
        return Err(format!("the image failed on {}:\n{text}", core.name).into());
    }
    let mut run = Run {
        counts: Vec::new(),
        commands: Vec::new(),
    };
    for line in text.lines() {
        match line.split_whitespace().collect::<Vec<_>>().as_slice() {
            ["stage", name, calls, total, min, max] => {
                let (calls, total): (u64, u64) = (calls.parse()?, total.parse()?);
                run.counts.push(Count {
                    stage: (*name).into(),
                    core: core.name,
                    calls,
                    mean: total as f64 / calls as f64,
                    min: min.parse()?,
                    max: max.parse()?,
                });
            }
            ["commands" | "commands-whole", digest @ ..] => run.commands.push(digest.join(" ")),
            ["overhead", overhead] => {
                eprintln!(
                    "{}: {overhead} instructions of counting and calling are subtracted",
                    core.name
                );
            }
            _ => return Err(format!("what the image printed is not understood: {line}").into()),
        }
    }
    Ok(run)
}
