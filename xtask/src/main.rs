//! Developer verbs that need more than cargo. `cargo xtask` without a verb prints them.

mod backup;
mod bench;
mod boards;
mod build;
mod conformance;
mod cost;
mod crates;
mod dfu;
mod dma;
mod flash;
mod guard;
mod image;
mod own_board;
mod params;
mod retained;
mod rig;
mod sizes;
mod stack;
mod toolchain;
mod tools;
mod vectors;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use boards::{BOARDS, Board};
use build::Variant;

/// Anything that ends a verb, as a sentence.
type Error = Box<dyn std::error::Error>;

/// Usage or input error: exit status 2.
#[derive(Debug)]
struct Refused(String);

impl std::fmt::Display for Refused {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl std::error::Error for Refused {}

const USAGE: &str = "\
usage: cargo xtask VERB

  firmware BOARD [--trace|--data-cache]
                     build the firmware and check its image; the last line is the path of the ELF. --trace: one that logs
                     every event of the executors, for `sophie timing` (docs/timing.md); --data-cache: one with the data
                     cache on, which matek-h743 flies without (docs/boards.md)
  flash BOARD [--dfu] [--trace|--data-cache|--elf ELF] [--backup FILE|--no-backup] [--dry]
                     build and flash: through probe-rs, which then shows the log, or with --dfu through dfu-util and the USB
                     loader of the chip (matek-h743, f405); stored parameters stay. --elf: flash this image, build none.
                     cuav-v5 is not flashed before its backup is there. --dry: only show the commands
  backup BOARD [FILE] [--dry]
                     read the whole flash through probe-rs, twice, into FILE (backups/BOARD.bin), which must not exist
  restore BOARD FILE [--dry]
                     write a backup over the whole flash through probe-rs
  bench BOARD [SCENARIO.toml] [--trace] [--seed N] [--out DIR] [--speed SHARE] [--console PORT]
        [--telemetry PORT] [--mavlink PORT] [--factory] [--pilot none] [--json]
                     build and fly a mission on the emulated board (matek-h743, f405); exit status 1 when it fails, 2 for bad
                     input
  sample BOARD [SCENARIO.toml] [--seeds FIRST-LAST] [--speed SHARE]
                     build and fly a mission with some seeds (1-10) on the host and on the emulated board (matek-h743, f405);
                     exit status 1 where outcome or phases differ
  chain BOARD [STEPS]
                     build, and count on the emulated board (matek-h743, f405) what steps (100) of the control path execute in
                     a hover, by part and by function (docs/cost.md)
  rig BOARD [--build|--emulated] [--wired] [--data-cache] [NAME...]
                     build the tests of a board and run them on it through probe-rs, or on the emulated board (matek-h743);
                     --wired fails what the wiring of hil/README.md lacks; names, or parts of them, choose tests
  sizes [--tighten]  build every board, print what it and each crate takes of flash, and of RAM, compare with xtask/ceilings.toml and with
                     the table in docs/boards.md; --tighten lowers the ceilings to what is taken now and writes the table
  cost [--tighten|--json|--cycles]
                     count the instructions of every control stage under QEMU, print them beside targets and peers,
                     compare with hil/qemu/cost/baseline.toml; --tighten takes what is counted now as the baseline and
                     writes the table of docs/cost.md; --cycles bounds the cycles on an M4F instead
  own-board          build a copy of the reference board as docs/porting.md says for a board of one's own, and check its
                     image
  conformance        run one image of exceptions, floats and control laws on QEMU and on the emulated core of the bench;
                     their logs must be equal

boards: matek-h743 (reference), cuav-v5, f405
variables: PROBE_RS_* as probe-rs knows them; RUSTFLAGS is kept and added to
exit status: 0 done, 1 failed, 2 not understood";

/// A parsed verb.
enum Verb<'a> {
    Firmware(&'static Board, Variant),
    Flash(flash::Flash<'a>),
    Backup(backup::Backup<'a>),
    Restore(backup::Backup<'a>),
    Bench(bench::Bench<'a>),
    Sample(bench::Sample<'a>),
    Chain(bench::Chain<'a>),
    Rig(rig::Rig<'a>),
    Sizes { tighten: bool },
    Cost(cost::Then),
    OwnBoard,
    Conformance,
    Help,
}

/// Every verb, in the order of [`USAGE`].
const VERBS: [&str; 12] = [
    "firmware",
    "flash",
    "backup",
    "restore",
    "bench",
    "sample",
    "chain",
    "rig",
    "sizes",
    "cost",
    "own-board",
    "conformance",
];

impl<'a> Verb<'a> {
    /// Parses `words`; the error explains why they are invalid.
    fn parse(words: &[&'a str]) -> Result<Self, String> {
        let (verb, rest) = match words {
            [] | ["help" | "-h" | "--help"] => return Ok(Self::Help),
            ["help", verb] => (*verb, &["--help"][..]),
            [verb, rest @ ..] => (*verb, rest),
        };
        if !VERBS.contains(&verb) {
            return Err(format!(
                "`{verb}` is not understood: allowed are {}, help",
                VERBS.join(", ")
            ));
        }
        if rest.iter().any(|word| ["-h", "--help"].contains(word)) {
            return Ok(Self::Help);
        }
        Ok(match verb {
            "firmware" => board(verb, rest).map(|(board, variant)| Self::Firmware(board, variant))?,
            "flash" => Self::Flash(flash::Flash::parse(rest)?),
            "backup" => Self::Backup(backup::Backup::parse(verb, rest)?),
            "restore" => Self::Restore(backup::Backup::parse(verb, rest)?),
            "bench" => Self::Bench(bench::Bench::parse(rest)?),
            "sample" => Self::Sample(bench::Sample::parse(rest)?),
            "chain" => Self::Chain(bench::Chain::parse(rest)?),
            "rig" => Self::Rig(rig::Rig::parse(rest)?),
            "sizes" => Self::Sizes {
                tighten: one_of(verb, rest, &["--tighten"])?.is_some(),
            },
            "cost" => Self::Cost(match one_of(verb, rest, &["--tighten", "--json", "--cycles"])? {
                Some("--tighten") => cost::Then::Tighten,
                Some("--cycles") => cost::Then::Cycles,
                Some(_) => cost::Then::Json,
                None => cost::Then::Compare,
            }),
            _ => {
                one_of(verb, rest, &[])?;
                if verb == "own-board" {
                    Self::OwnBoard
                } else {
                    Self::Conformance
                }
            }
        })
    }
}

/// One board, and which of its images.
fn board(verb: &str, words: &[&str]) -> Result<(&'static Board, Variant), String> {
    let (options, names): (Vec<&str>, Vec<&str>) = words.iter().partition(|word| word.starts_with('-'));
    let variant = one_of(verb, &options, &["--trace", "--data-cache"])?;
    let [name] = names[..] else {
        return Err(format!("{verb}: name exactly one board: {}", boards::names()));
    };
    let board = boards::find(name).ok_or_else(|| {
        format!(
            "{verb}: no board is called `{name}`; there are {}",
            boards::names()
        )
    })?;
    let variant = variant.and_then(Variant::asked).unwrap_or(Variant::Plain);
    let variant = variant.of(board).map_err(|e| format!("{verb}: {e}"))?;
    Ok((board, variant))
}

/// The one of `options` that `words` hold, if any; anything else is refused by its name.
fn one_of<'a>(verb: &str, words: &[&'a str], options: &[&str]) -> Result<Option<&'a str>, String> {
    let allowed = match options {
        [] => "nothing behind it".to_string(),
        _ => options.join(" or "),
    };
    match words {
        [] => Ok(None),
        [word] if options.contains(word) => Ok(Some(word)),
        [first, second, ..] if options.contains(first) && options.contains(second) => Err(format!(
            "{verb}: `{first} {second}` is not understood: allowed is {allowed}"
        )),
        _ => {
            let word = words.iter().find(|word| !options.contains(word)).unwrap_or(&"");
            Err(format!(
                "{verb}: `{word}` is not understood: allowed is {allowed}"
            ))
        }
    }
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let verb = match Verb::parse(&words) {
        Ok(verb) => verb,
        Err(complaint) => {
            eprintln!("{complaint}");
            return ExitCode::from(2);
        }
    };
    let done = match verb {
        Verb::Firmware(board, variant) => {
            firmware(board, variant).map(|(elf, _)| println!("{}", elf.display()))
        }
        Verb::Flash(flash) => flash.run(),
        Verb::Backup(backup) => backup.save(),
        Verb::Restore(backup) => backup.restore(),
        Verb::Bench(bench) => return ended(bench.board, bench.fly()),
        Verb::Sample(sample) => return ended(sample.board, sample.fly()),
        Verb::Chain(chain) => return ended(chain.board, chain.count()),
        Verb::Rig(rig) => return ended(rig.board, rig.run()),
        Verb::Sizes { tighten } => all_sizes(tighten),
        Verb::Cost(then) => cost::cost(then),
        Verb::OwnBoard => own_board::own_board(),
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
            ExitCode::from(if error.is::<Refused>() { 2 } else { 1 })
        }
    }
}

/// The exit status of a verb that has one of its own.
fn ended(board: &Board, status: Result<ExitCode, Error>) -> ExitCode {
    status.unwrap_or_else(|error| {
        eprintln!("{}: {error}", board.name);
        ExitCode::FAILURE
    })
}

/// Builds one board's firmware and checks its image.
fn firmware(board: &Board, variant: Variant) -> Result<(PathBuf, image::Image), Error> {
    let elf = build::firmware(board, variant)?;
    let image = check(board, &elf)?;
    let [stack, usb] = [sizes::stack(&image)?, stack::usb(&image)?];
    eprintln!("stack: {stack} bytes, of which USB's handlers take {usb} at most");
    eprintln!("build {:08x}, as 'version' at the console has it", image.build()?);
    Ok((elf, image))
}

/// Checks an image for a board: vector table, DMA reach of buffers, load addresses.
fn check(board: &Board, elf: &Path) -> Result<image::Image, Error> {
    let image = image::Image::read(elf)?;
    let vectors = vectors::check(board, &image)?;
    stack::check(board, &image)?;
    let buffers = dma::check(board, &image)?;
    eprintln!("vector table: {vectors} handlers, levels and reset in place");
    let outlives = retained::check(board, &image)?;
    let kept = params::check(board, &image)?;
    eprintln!("DMA: {buffers} buffers and task futures, all where their DMA reaches");
    eprintln!("retained: {outlives} bytes outlive a reset, where nothing else writes");
    if guard::check(board, &image)? {
        eprintln!("flash: read behind the guard against damaged words");
    }
    if kept > 0 {
        eprintln!("parameters: {kept} bytes of flash kept, nothing loaded there");
    }
    Ok(image)
}

fn all_sizes(tighten: bool) -> Result<(), Error> {
    let (mut rows, mut shares) = (Vec::new(), Vec::new());
    for board in &BOARDS {
        let (_, image) = firmware(board, Variant::Plain)?;
        let sizes = sizes::Sizes::of(board, &image)?;
        shares.push((board, crates::shares(&image, &sizes)?));
        rows.push((board, sizes));
    }
    crates::print(&shares);
    println!();
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
                matches!(Verb::parse(&["firmware", board.name]), Ok(Verb::Firmware(b, Variant::Plain)) if b.name == board.name)
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

    #[test]
    fn an_unknown_option_is_named_and_not_blamed_on_the_board() {
        for words in [
            &["firmware", "matek-h743", "--dry"] as &[&str],
            &["firmware", "--dry", "matek-h743", "--trace"],
            &["bench", "matek-h743", "--dry"],
            &[
                "bench",
                "f405",
                "tests/scenarios/perch-short.toml",
                "--seed",
                "3",
                "--dry",
            ],
            &["rig", "matek-h743", "--dry"],
            &["sizes", "--dry"],
            &["sizes", "--tighten", "--dry"],
            &["cost", "--dry"],
            &["conformance", "--dry"],
            &["own-board", "--dry"],
        ] {
            let complaint = Verb::parse(words).err().unwrap_or_default();
            let expected = format!("{}: `--dry` is not understood: allowed ", words[0]);
            assert!(
                complaint.starts_with(&expected) && !complaint.contains('\n'),
                "{words:?}: {complaint}"
            );
        }
        for (words, message) in [
            (
                &["flash", "f405", "--wet"] as &[&str],
                "flash: `--wet` is not understood: allowed are --dfu, --trace, --data-cache, --elf FILE, --backup FILE, --no-backup, --dry",
            ),
            (
                &["backup", "f405", "--wet"],
                "backup: `--wet` is not understood: allowed are a FILE and --dry",
            ),
            (
                &["backup", "f405", "a.bin", "b.bin"],
                "backup: `b.bin` is a second file: allowed is one",
            ),
            (
                &["restore", "f405"],
                "restore: name the FILE that `cargo xtask backup f405` wrote",
            ),
            (
                &["bench", "f405", "--seed"] as &[&str],
                "bench: `--seed` lacks its N",
            ),
            (
                &["bench", "f405", "--out", "--json"],
                "bench: `--out` lacks its DIR",
            ),
            (
                &["bench", "f405", "a.toml", "b.toml"],
                "bench: `b.toml` is a second scenario: allowed is one",
            ),
            (
                &["chain", "cuav-v5"],
                "chain: no board called `cuav-v5` is emulated: allowed is matek-h743, f405",
            ),
            (
                &["chain", "f405", "many"],
                "chain: `many` is not understood: allowed is a number of steps",
            ),
            (
                &["bench", "--json"],
                "bench: name the board first: allowed is matek-h743, f405",
            ),
            (
                &["cost", "--tighten", "--json"],
                "cost: `--tighten --json` is not understood: allowed is --tighten or --json or --cycles",
            ),
            (
                &["fly"],
                "`fly` is not understood: allowed are firmware, flash, backup, restore, bench, sample, chain, rig, sizes, cost, own-board, conformance, help",
            ),
        ] {
            assert_eq!(Verb::parse(words).err().as_deref(), Some(message), "{words:?}");
        }
    }

    #[test]
    fn every_verb_has_help() {
        for verb in VERBS {
            assert!(USAGE.contains(&format!("\n  {verb} ")), "{verb}");
            for words in [
                &["help", verb][..],
                &[verb, "--help"],
                &[verb, "matek-h743", "-h"],
            ] {
                assert!(matches!(Verb::parse(words), Ok(Verb::Help)), "{words:?}");
            }
        }
        assert!(Verb::parse(&["help", "fly"]).is_err());
    }
}
