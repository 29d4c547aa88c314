//! Builds a board's firmware with the available toolchain.

use std::ffi::OsString;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs};

use crate::Error;
use crate::boards::Board;
use crate::toolchain::{self, TARGET};

/// 2 ms of events and their frames, for a slow probe.
const TRACE_BUFFER: &str = "8192";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    /// The image that flies.
    Plain,
    /// Logs every event of the executors (docs/timing.md).
    Trace,
    /// Data cache on, for a board that flies without it (docs/boards.md).
    DataCache,
}

impl Variant {
    /// The variant of a command line option.
    pub fn asked(option: &str) -> Option<Self> {
        match option {
            "--trace" => Some(Self::Trace),
            "--data-cache" => Some(Self::DataCache),
            _ => None,
        }
    }

    /// The variant, checked for `board`.
    ///
    /// # Errors
    /// One line: the board has no such image.
    pub fn of(self, board: &Board) -> Result<Self, String> {
        if self == Self::DataCache && !board.data_cache_is_optional {
            return Err(format!(
                "--data-cache: {} has none to choose: allowed is matek-h743",
                board.name
            ));
        }
        Ok(self)
    }
}

/// Builds the firmware of `board`; returns its ELF.
///
/// # Errors
/// No toolchain, or the build failed (with output).
pub fn firmware(board: &Board, variant: Variant) -> Result<PathBuf, Error> {
    let (feature, variables): (_, &[_]) = match variant {
        Variant::Plain => ("", &[]),
        Variant::Trace => ("trace", &[("DEFMT_RTT_BUFFER_SIZE", TRACE_BUFFER)]),
        Variant::DataCache => ("data-cache", &[]),
    };
    let (features, kept) = if feature.is_empty() {
        (board.name.to_owned(), board.name.to_owned())
    } else {
        (
            format!("{},{feature}", board.name),
            format!("{}-{feature}", board.name),
        )
    };
    image(&Recipe {
        package: "sophie",
        arguments: &["--features", &features],
        variables,
        core: board.core,
        kept: &kept,
    })
}

/// Inputs of an image; profile and flags are common.
#[derive(Clone, Copy, Debug)]
pub struct Recipe<'a> {
    pub package: &'a str,
    pub arguments: &'a [&'a str],
    /// Environment variables: name and value.
    pub variables: &'a [(&'a str, &'a str)],
    /// Core, by rustc's name.
    pub core: &'a str,
    /// Suffix of the ELF's name.
    pub kept: &'a str,
}

/// Builds an image of this workspace; returns its ELF.
///
/// # Errors
/// No toolchain, or the build failed (with output).
pub fn image(recipe: &Recipe<'_>) -> Result<PathBuf, Error> {
    image_in(root(), recipe)
}

/// [`image`] of the workspace in `folder`.
///
/// # Errors
/// As [`image`].
pub fn image_in(folder: &Path, recipe: &Recipe<'_>) -> Result<PathBuf, Error> {
    let &Recipe {
        package,
        arguments,
        variables,
        core,
        kept,
    } = recipe;
    let toolchain = toolchain::find()?;
    eprintln!("{kept}: {}", toolchain.name);

    let mut command = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(folder);
    if folder != root() {
        // External crates are built once for both.
        command.env("CARGO_TARGET_DIR", target_dir());
    }
    command.args([
        "build",
        "--profile",
        "firmware",
        "--locked",
        "--package",
        package,
        "--target",
        TARGET,
    ]);
    command.args(arguments).args(toolchain.arguments);
    command.envs(toolchain.variables.iter().map(|(name, value)| (name, value)));
    command.envs(variables.iter().copied());
    // Only for speed: an image without it behaves the same.
    let mut flags = env::var_os("RUSTFLAGS").unwrap_or_default();
    if !flags.is_empty() {
        flags.push(" ");
    }
    flags.push(format!("-Ctarget-cpu={core}"));
    command.env("RUSTFLAGS", flags);
    eprintln!("{}", shown(&command));

    let mut cargo = command
        .arg("--message-format=json-render-diagnostics")
        .stdout(Stdio::piped())
        .spawn()?;
    let output = cargo.stdout.take().ok_or("cargo has no output")?;
    let mut built = None;
    for line in BufReader::new(output).lines() {
        let message: serde_json::Value = serde_json::from_str(&line?)?;
        if let Some(path) = message.get("executable").and_then(|p| p.as_str()) {
            built = Some(PathBuf::from(path));
        }
    }
    if !cargo.wait()?.success() {
        return Err(format!("{package} does not build for {kept}").into());
    }
    let built = built.ok_or("cargo built no executable")?;
    // Cargo names every board's image alike: keeps one of each.
    let copy = built.with_file_name(format!("{package}-{kept}.elf"));
    fs::copy(&built, &copy)?;
    Ok(copy)
}

pub fn root() -> &'static Path {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    here.parent().unwrap_or(here)
}

pub fn target_dir() -> PathBuf {
    env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), PathBuf::from)
}

/// A path relative to the workspace's folder.
pub fn typed(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).display().to_string()
}

/// The command as typed in a shell.
pub fn shown(command: &Command) -> String {
    let mut words = Vec::new();
    for (name, value) in command.get_envs() {
        let value = value.map(OsString::from).unwrap_or_default();
        let value = value.to_string_lossy();
        // The rest of the path is the user's.
        let value = if name == "PATH" {
            format!("{}:$PATH", value.split(':').next().unwrap_or(""))
        } else {
            value.into()
        };
        words.push(format!("{}={}", name.to_string_lossy(), quoted(&value)));
    }
    let program = Path::new(command.get_program());
    words.push(
        program
            .file_name()
            .unwrap_or(program.as_os_str())
            .to_string_lossy()
            .into(),
    );
    words.extend(command.get_args().map(|a| quoted(&a.to_string_lossy())));
    words.join(" ")
}

fn quoted(word: &str) -> String {
    if word.contains(' ') {
        format!("\"{word}\"")
    } else {
        word.to_string()
    }
}
