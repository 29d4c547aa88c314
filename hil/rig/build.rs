//! The board and its chip for the tests on a board, and their linker arguments; nothing for the host.

#[path = "../../src/board/selection.rs"]
mod selection;

use std::env;
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=../../src/board/memory");
    println!("cargo:rerun-if-changed=../../src/board/selection.rs");
    // The tests' macro asks for it.
    println!("cargo:rustc-check-cfg=cfg(rust_analyzer)");
    selection::declare();
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let chosen = match selection::selection(Path::new("../../src/board/memory")) {
        Ok(chosen) => chosen,
        Err(line) => {
            println!("cargo::error={line}");
            return Ok(());
        }
    };
    selection::apply(&chosen)?;
    for argument in ["-Tlink.x", "-Tdefmt.x", "-Tembedded-test.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-tests={argument}");
    }
    Ok(())
}
