//! `core ELF m4f|m7`: runs the conformance image on the emulated core and prints its log (`cargo xtask conformance`).

use std::path::Path;
use std::process::ExitCode;

use sophie_emulator::emulator::conformance::{CoreKind, run};

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (elf, kind) = match words.as_slice() {
        [elf, "m4f"] => (elf, CoreKind::M4F),
        [elf, "m7"] => (elf, CoreKind::M7),
        _ => {
            eprintln!("core: say `core ELF m4f` or `core ELF m7`");
            return ExitCode::from(2);
        }
    };
    match run(Path::new(elf), kind) {
        Ok(log) => {
            print!("{log}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{elf}: {error}");
            ExitCode::FAILURE
        }
    }
}
