//! Selects the board's file, chip and memory map by cargo's features.
//!
//! Whatever links for a board must add the linker arguments, which cargo does not pass on.

#[path = "src/output_pins.rs"]
mod output_pins;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

const MAPS: &str = "memory";
const FAMILIES: [&str; 3] = ["f4", "f7", "h7"];

struct Selection {
    map: PathBuf,
    /// Chip family, one of [`FAMILIES`].
    family: &'static str,
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=src/output_pins.rs");
    println!("cargo:rerun-if-changed={MAPS}");
    let families = FAMILIES.map(|family| format!("\"{family}\"")).join(", ");
    println!("cargo:rustc-check-cfg=cfg(family, values({families}))");
    if env::var("CARGO_CFG_TARGET_OS")? != "none" {
        return Ok(());
    }
    match selection() {
        Ok(chosen) => apply(&chosen)?,
        Err(line) => println!("cargo::error={line}"),
    }
    Ok(())
}

/// Board and chip of this build. Boards are named like their memory maps; chips are features `stm32…`.
///
/// # Errors
/// One line: no board or chip, several, or a family without shared code; a motor or servo on a pin that the chip pulls
/// up.
fn selection() -> Result<Selection, String> {
    let boards = boards().map_err(|error| format!("boards/{MAPS}: {error}"))?;
    let feature = |name: &str| format!("CARGO_FEATURE_{}", name.to_uppercase().replace('-', "_"));
    let chosen: Vec<&String> = boards
        .iter()
        .filter(|board| env::var_os(feature(board)).is_some())
        .collect();
    let [board] = chosen.as_slice() else {
        return Err(format!(
            "choose exactly one board with --features: {}",
            boards.join(", ")
        ));
    };
    let chips: Vec<String> = env::vars()
        .filter_map(|(name, _)| name.strip_prefix("CARGO_FEATURE_STM32").map(str::to_lowercase))
        .collect();
    let [chip] = chips.as_slice() else {
        return Err(format!(
            "the feature {board} of boards/Cargo.toml names {} chips: allowed is one of the chips' features, such as \
             stm32h743vi",
            chips.len()
        ));
    };
    let family = FAMILIES
        .into_iter()
        .find(|family| chip.starts_with(family))
        .ok_or_else(|| {
            format!(
                "stm32{chip} of the board {board}: boards/src/stm32 is written for the families {}",
                FAMILIES.join(", ")
            )
        })?;
    let file = format!("src/{}.rs", board.replace('-', "_"));
    println!("cargo:rerun-if-changed={file}");
    let table = fs::read_to_string(&file).map_err(|error| format!("boards/{file}: {error}"))?;
    output_pins::check(&table).map_err(|line| format!("boards/{file} {line}"))?;
    Ok(Selection {
        map: Path::new(MAPS).join(format!("{board}.x")),
        family,
    })
}

fn boards() -> io::Result<Vec<String>> {
    let mut boards = Vec::new();
    for entry in fs::read_dir(MAPS)? {
        let path = entry?.path();
        if path.extension().is_some_and(|e| e == "x") {
            boards.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
        }
    }
    boards.sort();
    Ok(boards)
}

/// Passes the board's map to the linker (included by memory.x at the workspace root, which is found first) and the
/// family to the compiler. The search path applies to all that links this crate.
fn apply(selection: &Selection) -> io::Result<()> {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    fs::copy(&selection.map, out.join("board.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-cfg=family=\"{}\"", selection.family);
    Ok(())
}
