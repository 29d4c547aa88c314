//! Flies a board's firmware on the emulated board.

use std::ffi::OsStr;
use std::process::{Command, ExitCode};

use crate::boards::{self, Board};
use crate::build::Variant;
use crate::{Error, build};

const EMULATED: [&str; 2] = ["matek-h743", "f405"];

/// Printed before the emulator's slow build.
const FIRST_BUILD: &str = "building the emulated board: minutes the first time, seconds from then on";

/// Options of the emulator without a value, and with one.
const ALONE: [&str; 3] = [TRACE, "--json", "--factory"];
const TRACE: &str = "--trace";
const WITH_VALUE: [(&str, &str); 7] = [
    ("--seed", "N"),
    ("--out", "DIR"),
    ("--speed", "SHARE"),
    ("--console", "PORT"),
    ("--telemetry", "PORT"),
    ("--mavlink", "PORT"),
    ("--pilot", "none"),
];

pub struct Bench<'a> {
    pub board: &'static Board,
    variant: Variant,
    rest: Vec<&'a str>,
}

impl<'a> Bench<'a> {
    /// Parses `words` behind the verb, before the minutes of building; the emulator checks values.
    ///
    /// # Errors
    /// One line: the fault and the allowed form.
    pub fn parse(words: &[&'a str]) -> Result<Self, String> {
        let (board, rest) = emulated("bench", words)?;
        let mut rest = passed_on("bench", rest, &WITH_VALUE, &ALONE)?;
        let all = rest.len();
        rest.retain(|word| *word != TRACE);
        let variant = if rest.len() < all {
            Variant::Trace
        } else {
            Variant::Plain
        };
        Ok(Self { board, variant, rest })
    }

    /// Builds and flies; returns the emulator's exit status.
    ///
    /// # Errors
    /// The firmware does not build.
    pub fn fly(&self) -> Result<ExitCode, Error> {
        let (elf, _) = crate::firmware(self.board, self.variant)?;
        emulator(
            "sophie-emulator",
            [OsStr::new(self.board.name), "--elf".as_ref(), elf.as_os_str()],
            &self.rest,
        )
    }
}

/// Words of `verb` passed to the emulator: one scenario, options `with_value` and options without (`alone`).
fn passed_on<'a>(
    verb: &str,
    words: &[&'a str],
    with_value: &[(&str, &str)],
    alone: &[&str],
) -> Result<Vec<&'a str>, String> {
    let mut taken = Vec::new();
    let mut scenario = false;
    let mut words = words.iter().copied();
    while let Some(word) = words.next() {
        let option = word.split('=').next().unwrap_or(word);
        taken.push(word);
        if let Some((_, value)) = with_value.iter().find(|(name, _)| *name == option) {
            if option == word {
                let given = words.next().filter(|next| !next.starts_with("--"));
                taken.push(given.ok_or_else(|| format!("{verb}: `{word}` lacks its {value}"))?);
            }
        } else if word.starts_with('-') && !alone.contains(&word) {
            let options = with_value.iter().map(|(name, value)| format!("{name} {value}"));
            let allowed: Vec<String> = options.chain(alone.iter().map(ToString::to_string)).collect();
            return Err(format!(
                "{verb}: `{word}` is not understood: allowed are a scenario, {}",
                allowed.join(", ")
            ));
        } else if !word.starts_with('-') && std::mem::replace(&mut scenario, true) {
            return Err(format!("{verb}: `{word}` is a second scenario: allowed is one"));
        }
    }
    Ok(taken)
}

/// Some seeds of a scenario, on the host and on the emulated board.
pub struct Sample<'a> {
    pub board: &'static Board,
    rest: Vec<&'a str>,
}

impl<'a> Sample<'a> {
    /// Parses `words` behind the verb; the emulator checks values.
    ///
    /// # Errors
    /// One line: the fault and the allowed form.
    pub fn parse(words: &[&'a str]) -> Result<Self, String> {
        let (board, rest) = emulated("sample", words)?;
        let options = [("--seeds", "FIRST-LAST"), ("--speed", "SHARE")];
        let rest = passed_on("sample", rest, &options, &[])?;
        Ok(Self { board, rest })
    }

    /// Builds, flies, compares; returns the emulator's exit status.
    ///
    /// # Errors
    /// The firmware does not build.
    pub fn fly(&self) -> Result<ExitCode, Error> {
        let (elf, _) = crate::firmware(self.board, Variant::Plain)?;
        emulator(
            "sample",
            [OsStr::new(self.board.name), "--elf".as_ref(), elf.as_os_str()],
            &self.rest,
        )
    }
}

/// The emulated board that `words` behind `verb` begins with, and the rest.
fn emulated<'w, 'a>(verb: &str, words: &'w [&'a str]) -> Result<(&'static Board, &'w [&'a str]), String> {
    let allowed = EMULATED.join(", ");
    let (name, rest) = match words {
        [name, rest @ ..] if !name.starts_with('-') => (*name, rest),
        _ => return Err(format!("{verb}: name the board first: allowed is {allowed}")),
    };
    let board = EMULATED.contains(&name).then(|| boards::find(name)).flatten();
    let board =
        board.ok_or_else(|| format!("{verb}: no board called `{name}` is emulated: allowed is {allowed}"))?;
    Ok((board, rest))
}

/// A count of the control path's instructions.
pub struct Chain<'a> {
    pub board: &'static Board,
    steps: Option<&'a str>,
}

impl<'a> Chain<'a> {
    /// Parses `words` behind the verb.
    ///
    /// # Errors
    /// One line: the fault and the allowed form.
    pub fn parse(words: &[&'a str]) -> Result<Self, String> {
        let (board, rest) = emulated("chain", words)?;
        let steps = match rest {
            [] => None,
            [steps] if steps.parse::<usize>().is_ok() => Some(*steps),
            [word] | [_, word, ..] => {
                return Err(format!(
                    "chain: `{word}` is not understood: allowed is a number of steps"
                ));
            }
        };
        Ok(Self { board, steps })
    }

    /// Builds, flies, prints the counts; returns the emulator's exit status.
    ///
    /// # Errors
    /// The firmware does not build.
    pub fn count(&self) -> Result<ExitCode, Error> {
        let (elf, _) = crate::firmware(self.board, Variant::Plain)?;
        let steps: Vec<&str> = self.steps.into_iter().collect();
        emulator("chain", [OsStr::new(self.board.name), elf.as_os_str()], &steps)
    }
}

/// Builds and runs the emulator's binary `name` with `arguments` and the caller's additions; returns its exit status.
///
/// # Errors
/// Cargo does not start.
pub fn emulator<'a>(
    name: &str,
    arguments: impl IntoIterator<Item = &'a OsStr>,
    rest: &[&str],
) -> Result<ExitCode, Error> {
    let mut command = run(name);
    command.args(arguments).args(rest);
    eprintln!("{FIRST_BUILD}");
    eprintln!("{}", build::shown(&command));
    let status = command.status()?;
    Ok(ExitCode::from(
        u8::try_from(status.code().unwrap_or(1)).unwrap_or(1),
    ))
}

/// With cargo's progress on stderr.
fn run(name: &str) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // The emulator declares a newer Rust than it needs.
    command.args([
        "run",
        "--profile",
        "emulator",
        "--locked",
        "--ignore-rust-version",
    ]);
    // Not from the workspace: paths in arguments are the caller's.
    command
        .arg("--manifest-path")
        .arg(build::root().join("Cargo.toml"));
    command.args(["--package", "sophie-emulator", "--bin", name, "--"]);
    command
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_minutes_of_the_first_build_are_not_silent() {
        let command = run("sophie-emulator");
        let words: Vec<_> = command
            .get_args()
            .map(|word| word.to_string_lossy().into_owned())
            .collect();
        assert!(
            !words.iter().any(|w| ["--quiet", "-q"].contains(&w.as_str())),
            "{words:?}"
        );
        assert!(FIRST_BUILD.contains("minutes") && FIRST_BUILD.contains("emulat"));
    }

    #[test]
    fn what_the_emulator_takes_is_passed_on() {
        let words = [
            "f405",
            "a.toml",
            "--seed",
            "3",
            "--trace",
            "--speed=0.5",
            "--out",
            "x",
            "--json",
        ];
        let bench = Bench::parse(&words).ok().unwrap();
        assert!(bench.board.name == "f405" && bench.variant == Variant::Trace);
        assert_eq!(
            bench.rest,
            ["a.toml", "--seed", "3", "--speed=0.5", "--out", "x", "--json"]
        );
        let complaint = Bench::parse(&["cuav-v5"]).err().unwrap();
        assert_eq!(
            complaint,
            "bench: no board called `cuav-v5` is emulated: allowed is matek-h743, f405"
        );
    }
    #[test]
    fn a_sample_takes_a_scenario_and_its_seeds_alone() {
        let words = ["f405", "a.toml", "--seeds", "1-10", "--speed=0.5"];
        let sample = Sample::parse(&words).ok().unwrap();
        assert_eq!(sample.rest, words[1..]);
        for (words, complaint) in [
            (&["f405", "--seeds"][..], "sample: `--seeds` lacks its FIRST-LAST"),
            (
                &["f405", "--json"],
                "sample: `--json` is not understood: allowed are a scenario, --seeds FIRST-LAST, --speed SHARE",
            ),
        ] {
            assert_eq!(Sample::parse(words).err().as_deref(), Some(complaint));
        }
    }

    #[test]
    fn steps_may_be_asked_for() {
        for (words, steps) in [(&["f405"][..], None), (&["f405", "7"], Some("7"))] {
            let chain = Chain::parse(words).ok().unwrap();
            assert_eq!((chain.board.name, chain.steps), ("f405", steps));
        }
    }
}
