//! Developer verbs that need more than cargo. `cargo xtask` without a verb prints them.

mod bench;
mod boards;
mod build;
mod conformance;
mod cost;
mod dma;
mod image;
mod params;
mod rig;
mod sizes;
mod toolchain;
mod vectors;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use boards::{BOARDS, Board};
use build::Trace;

/// Anything that ends a verb, as a sentence.
type Error = Box<dyn std::error::Error>;

const USAGE: &str = "\
usage: cargo xtask VERB

  firmware BOARD [--trace]
                     build the firmware and check its image; the last line is the path of the ELF. --trace: one that logs
                     every event of the executors, for `sophie timing` (docs/timing.md)
  flash BOARD [--trace]
                     build, flash through probe-rs and show the log
  bench BOARD [SCENARIO.toml] [--trace] [--seed N] [--out DIR] [--speed SHARE] [--console PORT]
        [--telemetry PORT] [--json]
                     build and fly a mission on the emulated board (matek-h743, f405); exit status 1 when it fails, 2 for bad
                     input
  rig BOARD [--build|--emulated] [--wired] [NAME...]
                     build the tests of a board and run them on it through probe-rs, or on the emulated board (matek-h743);
                     --wired fails what the wiring of hil/README.md lacks; names, or parts of them, choose tests
  sizes [--tighten]  build every board, print what it takes of flash and RAM, compare with xtask/ceilings.toml and with
                     the table in docs/boards.md; --tighten lowers the ceilings to what is taken now and writes the table
  cost [--tighten|--json]
                     count the instructions of every control stage under QEMU, print them beside targets and peers,
                     compare with hil/cost/baseline.toml; --tighten takes what is counted now as the baseline and
                     writes the table of docs/cost.md
  conformance        run one image of exceptions, floats and control laws on QEMU and on the emulated core of the bench;
                     their logs must be equal

boards: matek-h743 (reference), cuav-v5, f405
variables: PROBE_RS_* as probe-rs knows them; RUSTFLAGS is kept and added to
exit status: 0 done, 1 failed, 2 not understood";

/// What is to be done.
enum Verb {
    Firmware(&'static Board, Trace),
    Flash(&'static Board, Trace),
    Sizes { tighten: bool },
    Cost(cost::Then),
    Conformance,
    Help,
}

impl Verb {
    /// What `words` ask for; else why they are not understood.
    fn parse(words: &[&str]) -> Result<Self, String> {
        let one_board = |names: &[&str]| match names {
            [name, trace @ ..] if trace.is_empty() || trace == ["--trace"] => boards::find(name)
                .map(|board| (board, if trace.is_empty() { Trace::Off } else { Trace::On }))
                .ok_or_else(|| format!("no board is called `{name}`; there are {}", boards::names())),
            _ => Err(format!("name exactly one board: {}", boards::names())),
        };
        match words {
            [] | ["help" | "-h" | "--help"] => Ok(Self::Help),
            ["firmware", names @ ..] => one_board(names).map(|(board, trace)| Self::Firmware(board, trace)),
            ["flash", names @ ..] => one_board(names).map(|(board, trace)| Self::Flash(board, trace)),
            ["sizes"] => Ok(Self::Sizes { tighten: false }),
            ["sizes", "--tighten"] => Ok(Self::Sizes { tighten: true }),
            ["conformance"] => Ok(Self::Conformance),
            ["cost"] => Ok(Self::Cost(cost::Then::Compare)),
            ["cost", "--json"] => Ok(Self::Cost(cost::Then::Json)),
            ["cost", "--tighten"] => Ok(Self::Cost(cost::Then::Tighten)),
            _ => Err(format!(
                "`{}` is not understood; `cargo xtask help` shows what is",
                words.join(" ")
            )),
        }
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["bench", rest @ ..] => return bench(rest),
        ["rig", rest @ ..] => return rig(rest),
        _ => {}
    }
    let verb = match Verb::parse(&words) {
        Ok(verb) => verb,
        Err(complaint) => {
            eprintln!("{complaint}");
            return ExitCode::from(2);
        }
    };
    let done = match verb {
        Verb::Firmware(board, trace) => firmware(board, trace).map(|(elf, _)| println!("{}", elf.display())),
        Verb::Flash(board, trace) => flash(board, trace),
        Verb::Sizes { tighten } => all_sizes(tighten),
        Verb::Cost(then) => cost::cost(then),
        Verb::Conformance => conformance::conformance(),
        Verb::Help => {
            println!("{USAGE}");
            Ok(())
        }
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn bench(words: &[&str]) -> ExitCode {
    let (board, status) = match bench::board(words) {
        Ok(board) => (board, bench::fly(board, words.get(1..).unwrap_or_default())),
        Err(complaint) => {
            eprintln!("{complaint}");
            return ExitCode::from(2);
        }
    };
    status.unwrap_or_else(|error| {
        eprintln!("{}: {error}", board.name);
        ExitCode::FAILURE
    })
}

fn rig(words: &[&str]) -> ExitCode {
    let rig = match rig::Rig::parse(words) {
        Ok(rig) => rig,
        Err(complaint) => {
            eprintln!("{complaint}");
            return ExitCode::from(2);
        }
    };
    rig.run().unwrap_or_else(|error| {
        eprintln!("{}: {error}", rig.board.name);
        ExitCode::FAILURE
    })
}

/// Builds one board's firmware and checks its image.
fn firmware(board: &Board, trace: Trace) -> Result<(PathBuf, image::Image), Error> {
    let elf = build::firmware(board, trace)?;
    let image = check(board, &elf)?;
    Ok((elf, image))
}

/// Checks an image for a board: its vectors, what DMA reaches, what is loaded where.
fn check(board: &Board, elf: &Path) -> Result<image::Image, Error> {
    let image = image::Image::read(elf)?;
    let vectors = vectors::check(board, &image)?;
    let buffers = dma::check(board, &image)?;
    eprintln!("vector table: {vectors} handlers, levels and reset in place");
    let kept = params::check(&image)?;
    eprintln!("DMA: {buffers} buffers and task futures, all where their DMA reaches");
    if kept > 0 {
        eprintln!("parameters: {kept} bytes of flash kept, nothing loaded there");
    }
    Ok(image)
}

fn flash(board: &Board, trace: Trace) -> Result<(), Error> {
    let (elf, _) = firmware(board, trace)?;
    let mut command = Command::new("probe-rs");
    // The firmware drops log lines rather than wait for a probe; the probe must not make it wait either.
    command
        .args([
            "run",
            "--chip",
            board.probe_rs_chip,
            "--rtt-channel-mode",
            "no-block-trim",
        ])
        .arg(&elf);
    eprintln!("{}", build::shown(&command));
    let status = command.status().map_err(|e| match e.kind() {
        std::io::ErrorKind::NotFound => {
            "probe-rs is not installed; see https://probe.rs/docs/getting-started/installation".to_string()
        }
        _ => e.to_string(),
    })?;
    if status.success() {
        Ok(())
    } else {
        Err("probe-rs failed".into())
    }
}

fn all_sizes(tighten: bool) -> Result<(), Error> {
    let mut rows = Vec::new();
    for board in &BOARDS {
        rows.push((board, sizes::Sizes::of(&firmware(board, Trace::Off)?.1)?));
    }
    sizes::print(&rows);
    sizes::compare(&rows, tighten)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exactly_one_board_that_exists_is_built() {
        for board in &BOARDS {
            assert!(
                matches!(Verb::parse(&["firmware", board.name]), Ok(Verb::Firmware(b, Trace::Off)) if b.name == board.name)
            );
        }
        for words in [
            &["firmware"] as &[&str],
            &["firmware", "matek"],
            &["firmware", "matek-h743", "f405"],
            &["flash"],
            &["sizes", "--loosen"],
            &["fly"],
        ] {
            let complaint = Verb::parse(words).err().unwrap_or_default();
            assert!(!complaint.is_empty() && !complaint.contains('\n'), "{words:?}");
        }
    }
}
