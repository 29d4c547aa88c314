//! Linker arguments of the firmware; nothing for the host. The board is picked in `boards/build.rs`.
//!
//! They stand here and not in `rustflags`, because a `RUSTFLAGS` in the environment would silently replace those.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rerun-if-changed=memory.x");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        // Without `--nmagic` sections are aligned to pages that the chip does not have.
        for argument in ["-Tlink.x", "-Tdefmt.x", "--nmagic"] {
            println!("cargo:rustc-link-arg-bins={argument}");
        }
    }
}
