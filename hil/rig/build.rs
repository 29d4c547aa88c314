//! Linker arguments of the tests on a board; nothing for the host.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

/// Board features; each has its memory map in `src/board/memory/`.
const BOARDS: [&str; 3] = ["matek-h743", "cuav-v5", "f405"];

fn main() -> Result<(), Box<dyn Error>> {
    let maps = "../../src/board/memory";
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed={maps}");
    // The tests' macro asks for it.
    println!("cargo:rustc-check-cfg=cfg(rust_analyzer)");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let chosen = |board: &&str| {
        let feature = board.to_uppercase().replace('-', "_");
        env::var_os(format!("CARGO_FEATURE_{feature}")).is_some()
    };
    let chosen: Vec<&str> = BOARDS.into_iter().filter(chosen).collect();
    let [board] = chosen.as_slice() else {
        println!(
            "cargo::error=choose exactly one board with --features: {}",
            BOARDS.join(", ")
        );
        return Ok(());
    };

    // memory.x at the workspace root, which the linker finds first, includes this.
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(format!("{maps}/{board}.x"), out.join("board.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    for argument in ["-Tlink.x", "-Tdefmt.x", "-Tembedded-test.x", "--nmagic"] {
        println!("cargo:rustc-link-arg-tests={argument}");
    }
    Ok(())
}
