//! `rig ELF [NAME...]`: runs a board's tests (`hil/rig`), or those with NAME in theirs, on the emulated board (`cargo
//! xtask rig matek-h743 --emulated`).
//!
//! Exit status: 0 when every test passed, 1 when not, 2 for bad input.

use std::path::Path;
use std::process::ExitCode;

use sophie_emulator::elf::Firmware;
use sophie_emulator::emulator::rig::{Defect, read, run};
use sophie_emulator::gaps;
use sophie_emulator::suite::{self, Test};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [elf, names @ ..] = arguments.as_slice() else {
        eprintln!("rig: say `rig ELF`, with parts of names of tests behind it or none");
        return ExitCode::from(2);
    };
    let tests = read(Path::new(elf)).and_then(|image| {
        let tests = suite::tests(&image)?;
        Ok((image, tests))
    });
    let (image, tests) = match tests {
        Ok(read) => read,
        Err(line) => {
            eprintln!("rig: {line}");
            return ExitCode::from(2);
        }
    };
    let named = |test: &&Test| {
        let chosen = names.iter().any(|name| test.name.contains(name.as_str()));
        chosen || names.is_empty() && !test.ignored
    };
    let chosen: Vec<&Test> = tests.iter().filter(named).collect();
    if chosen.is_empty() {
        eprintln!("rig: no test is called {}", names.join(" or "));
        return ExitCode::from(2);
    }
    let failed = chosen.iter().filter(|test| !passes(&image, test)).count();
    println!("{} passed, {failed} failed", chosen.len() - failed);
    ExitCode::from(u8::from(failed > 0))
}

fn passes(image: &Firmware, test: &Test) -> bool {
    let verdict = run(image, test, Defect::None).and_then(|ended| {
        for line in &ended.lines {
            println!("    {line}");
        }
        if let Some(gap) = gaps::not_allowed(&ended.gaps)?.first() {
            return Err(format!(
                "the emulator cannot vouch for {} {}: {}",
                gap.kind, gap.at, gap.what
            ));
        }
        match ended.status {
            Some(status) if (status == 0) != test.should_panic => Ok(()),
            Some(status) => Err(format!("status {status}")),
            None => Err("did not end".to_owned()),
        }
    });
    match verdict {
        Ok(()) => println!("test {} ... ok", test.name),
        Err(ref why) => println!("test {} ... FAILED: {why}", test.name),
    }
    verdict.is_ok()
}
