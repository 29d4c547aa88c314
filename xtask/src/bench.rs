//! Flies the firmware of a board on the emulated board.

use std::ffi::OsStr;
use std::process::{Command, ExitCode};

use crate::boards::{self, Board};
use crate::build::Trace;
use crate::{Error, build};

/// Boards that can be emulated.
const EMULATED: [&str; 2] = ["matek-h743", "f405"];

/// The board that `words`, the arguments behind the verb, begin with, if it can be emulated.
///
/// # Errors
/// One line: the board and what is allowed.
pub fn board(words: &[&str]) -> Result<&'static Board, String> {
    let allowed = EMULATED.join(", ");
    let name = words
        .first()
        .ok_or_else(|| format!("bench: name the board first: allowed is {allowed}"))?;
    if !EMULATED.contains(name) {
        return Err(format!(
            "bench: no board called `{name}` is emulated: allowed is {allowed}"
        ));
    }
    boards::find(name).ok_or_else(|| format!("no board is called `{name}`; there are {}", boards::names()))
}

/// Builds and flies; the exit status is the bench's own.
///
/// # Errors
/// The firmware does not build.
pub fn fly(board: &Board, rest: &[&str]) -> Result<ExitCode, Error> {
    let (trace, rest): (Vec<&str>, Vec<&str>) = rest.iter().partition(|word| **word == "--trace");
    let trace = if trace.is_empty() { Trace::Off } else { Trace::On };
    let (elf, _) = crate::firmware(board, trace)?;
    emulator(
        "sophie-bench",
        [OsStr::new(board.name), "--elf".as_ref(), elf.as_os_str()],
        &rest,
    )
}

/// Builds the emulator and runs its binary `name` with `arguments` and what the caller adds; the exit status is its own.
///
/// # Errors
/// Cargo does not start.
pub fn emulator<'a>(
    name: &str,
    arguments: impl IntoIterator<Item = &'a OsStr>,
    rest: &[&str],
) -> Result<ExitCode, Error> {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // The emulator declares a newer Rust than it needs.
    command.args([
        "run",
        "--quiet",
        "--profile",
        "emulator",
        "--locked",
        "--ignore-rust-version",
    ]);
    // Not from the workspace's folder: paths in the arguments are the caller's.
    command
        .arg("--manifest-path")
        .arg(build::root().join("Cargo.toml"));
    command.args(["--package", "sophie-bench", "--bin", name, "--"]);
    command.args(arguments).args(rest);
    eprintln!("{}", build::shown(&command));
    let status = command.status()?;
    Ok(ExitCode::from(
        u8::try_from(status.code().unwrap_or(1)).unwrap_or(1),
    ))
}
