//! The conformance image on QEMU and on the emulated core: equal logs, and the laws' lines equal to the host's, so that
//! its tests hold for the chip.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Stdio};

use crate::build::Recipe;
use crate::cost::{CORES, Core};
use crate::{Error, build};

const SHOWN: usize = 5;

/// Builds the image for each core, runs it on both, compares.
///
/// # Errors
/// No toolchain or QEMU, a failing image, or different logs.
pub fn conformance() -> Result<(), Error> {
    let laws = output(cargo().args(["run", "--quiet", "--locked", "--package", "sophie-conformance"]))?;
    for core in &CORES {
        let features: &[&str] = if core.name == "M7" {
            &["--features", "m7"]
        } else {
            &[]
        };
        let elf = build::image(&Recipe {
            package: "sophie-conformance",
            arguments: features,
            variables: &[],
            core: core.cpu,
            kept: core.cpu,
        })?;
        let qemu = output(&mut qemu(core, &elf))?;
        let emulated = output(&mut emulated(core, &elf))?;
        let host = qemu
            .lines()
            .take(laws.lines().count())
            .collect::<Vec<_>>()
            .join("\n");
        compare(core.name, "the host", laws.trim_end(), "QEMU", &host)?;
        compare(core.name, "QEMU", &qemu, "the emulator", &emulated)?;
        println!(
            "{}: {} lines alike on QEMU and the emulator, {} of them also on the host",
            core.name,
            qemu.lines().count(),
            laws.lines().count()
        );
    }
    Ok(())
}

fn compare(core: &str, one: &str, first: &str, other: &str, second: &str) -> Result<(), Error> {
    let (first, second): (Vec<&str>, Vec<&str>) = (first.lines().collect(), second.lines().collect());
    let differing: Vec<String> = first
        .iter()
        .zip(&second)
        .filter(|(a, b)| a != b)
        .map(|(a, b)| format!("  {one}: {a}\n  {other}: {b}"))
        .collect();
    if first.is_empty() {
        return Err(format!("{core}: {one} printed nothing").into());
    }
    if differing.is_empty() && first.len() == second.len() {
        return Ok(());
    }
    let shown = differing
        .iter()
        .take(SHOWN)
        .cloned()
        .collect::<Vec<_>>()
        .join("\n");
    Err(format!(
        "{core}: {one} printed {} lines, {other} {}; {} differ:\n{shown}",
        first.len(),
        second.len(),
        differing.len()
    )
    .into())
}

fn qemu(core: &Core, elf: &Path) -> Command {
    let mut command = Command::new("qemu-system-arm");
    command.args(["-machine", core.machine, "-nographic"]);
    command.args(["-semihosting-config", "enable=on,target=native", "-kernel"]);
    command.arg(elf);
    command
}

fn emulated(core: &Core, elf: &Path) -> Command {
    let mut command = cargo();
    // As for the bench: one build of the emulator serves both.
    command.args([
        "run",
        "--quiet",
        "--profile",
        "emulator",
        "--locked",
        "--ignore-rust-version",
    ]);
    command.args(["--package", "sophie-emulator", "--bin", "core", "--"]);
    command.arg(elf).arg(core.name.to_lowercase());
    command
}

fn cargo() -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(build::root());
    command
}

fn output(command: &mut Command) -> Result<String, Error> {
    eprintln!("{}", build::shown(command));
    let output = command
        .stdin(Stdio::null())
        .stderr(Stdio::inherit())
        .output()
        .map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound if command.get_program() == OsStr::new("qemu-system-arm") => {
                "qemu-system-arm is not installed (Debian, Ubuntu: apt-get install qemu-system-arm)"
                    .to_string()
            }
            _ => e.to_string(),
        })?;
    let text = String::from_utf8(output.stdout)?;
    if output.status.success() {
        Ok(text)
    } else {
        Err(format!("{} failed:\n{text}", build::shown(command)).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_that_differ_are_told_from_logs_that_do_not() {
        let compare = |a: &str, b: &str| compare("M7", "one", a, "other", b);
        assert!(compare("a: 1\nb: 2", "a: 1\nb: 2").is_ok());
        let error = compare("a: 1\nb: 2", "a: 1\nb: 3").unwrap_err().to_string();
        assert!(
            error.contains("1 differ") && error.contains("other: b: 3"),
            "{error}"
        );
        assert!(compare("a: 1\nb: 2", "a: 1").is_err());
        assert!(compare("", "").is_err());
    }
}
