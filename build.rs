//! Linker arguments of the firmware; `boards/build.rs` picks the board. Not in `rustflags`: a `RUSTFLAGS` variable
//! silently replaces them.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=memory.x");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        // Without `--nmagic` sections are aligned to pages, which the chip lacks.
        for argument in ["-Tlink.x", "-Tdefmt.x", "--nmagic"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}
