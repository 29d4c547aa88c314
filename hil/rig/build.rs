//! Linker arguments of the tests; none for the host. `boards/build.rs` picks the board.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // Used by the tests' macro.
    println!("cargo:rustc-check-cfg=cfg(rust_analyzer)");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        for argument in ["-Tlink.x", "-Tdefmt.x", "-Tembedded-test.x", "--nmagic"] {
            println!("cargo:rustc-link-arg-tests={argument}");
        }
    }
}
