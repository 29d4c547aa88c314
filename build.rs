//! Linker arguments of the firmware; nothing for the host.
//!
//! They stand here and not in `rustflags`, because a `RUSTFLAGS` in the environment would silently replace those.

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};

/// Board features; each has its memory map in `src/board/memory/`.
const BOARDS: [&str; 3] = ["matek-h743", "cuav-v5", "f405"];

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=memory.x");
    println!("cargo:rerun-if-changed=src/board/memory");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    let chosen = |board: &&str| {
        let feature = board.to_uppercase().replace('-', "_");
        env::var_os(format!("CARGO_FEATURE_{feature}")).is_some()
    };
    let chosen: Vec<&str> = BOARDS.into_iter().filter(chosen).collect();
    // None; or several that cargo does not know to tell apart (src/board/choice): those it refuses before it builds anything.
    let [board] = chosen.as_slice() else {
        println!(
            "cargo::error=choose exactly one board with --features: {}",
            BOARDS.join(", ")
        );
        return Ok(());
    };

    // memory.x at the workspace root, which the linker finds first, includes this.
    let out = PathBuf::from(env::var("OUT_DIR")?);
    fs::copy(format!("src/board/memory/{board}.x"), out.join("board.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    println!("cargo:rustc-link-arg-bins=-Tdefmt.x");
    // Sections are not aligned to pages that the chip does not have.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    Ok(())
}
