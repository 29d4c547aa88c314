//! The board and its chip for the firmware, and its linker arguments; nothing for the host.
//!
//! They stand here and not in `rustflags`, because a `RUSTFLAGS` in the environment would silently replace those.

#[path = "src/board/selection.rs"]
mod selection;

use std::env;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=src/board/memory");
    println!("cargo:rerun-if-changed=src/board/selection.rs");
    selection::declare();
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let chosen = match selection::selection(Path::new("src/board/memory")) {
        Ok(chosen) => chosen,
        Err(line) => {
            println!("cargo::error={line}");
            return Ok(());
        }
    };
    selection::apply(&chosen)?;
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    // Sections are not aligned to pages that the chip does not have.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    Ok(())
}
