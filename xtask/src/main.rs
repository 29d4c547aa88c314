//! Developer verbs that need more than cargo. `cargo xtask` without a verb prints them.

mod boards;
mod build;
mod cost;
mod dma;
mod image;
mod sizes;
mod toolchain;
mod vectors;

use std::path::PathBuf;
use std::process::{Command, ExitCode};

use boards::{BOARDS, Board};

/// Anything that ends a verb, as a sentence.
type Error = Box<dyn std::error::Error>;

const USAGE: &str = "\
usage: cargo xtask VERB

  firmware BOARD     build the firmware and check its image; the last line is the path of the ELF
  flash BOARD        build, flash through probe-rs and show the log
  sizes [--tighten]  build every board, print what it takes of flash and RAM, compare with xtask/ceilings.toml;
                     --tighten lowers the ceilings to what is taken now
  cost [--tighten|--json]
                     count the instructions of every control stage under QEMU, print them beside targets and peers,
                     compare with hil/cost/baseline.toml; --tighten takes what is counted now as the baseline and
                     writes the table of docs/cost.md

boards: matek-h743 (reference), cuav-v5, f405
variables: PROBE_RS_* as probe-rs knows them; RUSTFLAGS is kept and added to";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let done = match words.as_slice() {
        ["firmware", board] => boards::find(board).and_then(|board| {
            let (elf, _) = firmware(board)?;
            println!("{}", elf.display());
            Ok(())
        }),
        ["flash", board] => boards::find(board).and_then(flash),
        ["sizes"] => all_sizes(false),
        ["sizes", "--tighten"] => all_sizes(true),
        ["cost"] => cost::cost(cost::Then::Compare),
        ["cost", "--json"] => cost::cost(cost::Then::Json),
        ["cost", "--tighten"] => cost::cost(cost::Then::Tighten),
        [] | ["help" | "-h" | "--help"] => {
            println!("{USAGE}");
            Ok(())
        }
        _ => Err(USAGE.into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

/// Builds one board's firmware and checks its image.
fn firmware(board: &Board) -> Result<(PathBuf, image::Image), Error> {
    let elf = build::firmware(board)?;
    let image = image::Image::read(&elf)?;
    let vectors = vectors::check(board, &image)?;
    let buffers = dma::check(board, &image)?;
    eprintln!("vector table: {vectors} handlers, levels and reset in place");
    eprintln!("DMA: {buffers} buffers and task futures, all where their DMA reaches");
    Ok((elf, image))
}

fn flash(board: &Board) -> Result<(), Error> {
    let (elf, _) = firmware(board)?;
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
        rows.push((board, sizes::Sizes::of(&firmware(board)?.1)?));
    }
    sizes::table(&rows);
    sizes::compare(&rows, tighten)
}
