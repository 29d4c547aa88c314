//! Linker arguments of the firmware; none for the host. `boards/build.rs` picks the board.
//!
//! Not in `rustflags`, which a `RUSTFLAGS` in the environment silently replaces.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=memory.x");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        // Without `--nmagic` sections are aligned to pages, which the chip does not have.
        for argument in ["-Tlink.x", "-Tdefmt.x", "--nmagic"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}
