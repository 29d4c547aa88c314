//! Which board and which chip cargo's features name: for the build scripts of the firmware and of a board's tests.

#[path = "output_pins.rs"]
mod output_pins;

use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Families of chips that `src/board/stm32/` and `src/board/cortex_m/` have been written for.
const FAMILIES: [&str; 3] = ["f4", "f7", "h7"];

/// What is built for.
pub struct Selection {
    /// The board's memory map, called as its feature.
    pub map: PathBuf,
    /// The family of its chip, one of [`FAMILIES`].
    pub family: &'static str,
}

/// Tells the compiler which families there are; for the host as well.
pub fn declare() {
    let values = FAMILIES.map(|family| format!("\"{family}\"")).join(", ");
    println!("cargo:rustc-check-cfg=cfg(family, values({values}))");
}

/// The board and the chip of this build. Boards are the memory maps in `maps`, their files beside that folder; chips are
/// features called `stm32…`.
///
/// # Errors
/// One line: no board or several, no chip or several, or one of a family without shared code; a motor or a servo on a
/// pin that the chip pulls up by itself.
pub fn selection(maps: &Path) -> Result<Selection, String> {
    let told = |error: io::Error| format!("{}: {error}", maps.display());
    let mut boards: Vec<String> = Vec::new();
    for entry in fs::read_dir(maps).map_err(told)? {
        let path = entry.map_err(told)?.path();
        if let Some(stem) = path
            .file_stem()
            .filter(|_| path.extension().is_some_and(|e| e == "x"))
        {
            boards.push(stem.to_string_lossy().into_owned());
        }
    }
    boards.sort();
    let feature = |name: &str| format!("CARGO_FEATURE_{}", name.to_uppercase().replace('-', "_"));
    let chosen: Vec<&String> = boards
        .iter()
        .filter(|board| env::var_os(feature(board)).is_some())
        .collect();
    // None; or several that cargo does not know to tell apart (src/board/choice): those it refuses before it builds.
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
            "the feature {board} of Cargo.toml names {} chips: allowed is one of the chips' features, such as stm32h743vi",
            chips.len()
        ));
    };
    let family = FAMILIES
        .into_iter()
        .find(|family| chip.starts_with(family))
        .ok_or_else(|| {
            format!(
                "stm32{chip} of the board {board}: src/board/stm32 is written for the families {}",
                FAMILIES.join(", ")
            )
        })?;
    let file = maps.with_file_name(format!("{}.rs", board.replace('-', "_")));
    println!("cargo:rerun-if-changed={}", file.display());
    let table = fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    output_pins::check(&table).map_err(|line| format!("{} {line}", file.display()))?;
    Ok(Selection {
        map: maps.join(format!("{board}.x")),
        family,
    })
}

/// Gives the linker the map of the board (memory.x at the workspace root, which it finds first, includes it), and the
/// compiler the family.
///
/// # Errors
/// The map cannot be copied.
pub fn apply(selection: &Selection) -> io::Result<()> {
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    fs::copy(&selection.map, out.join("board.x"))?;
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rustc-cfg=family=\"{}\"", selection.family);
    Ok(())
}
