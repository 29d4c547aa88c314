//! Linker arguments of the tests on a board; nothing for the host. The board is picked in `boards/build.rs`.

use std::env;

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    // The tests' macro asks for it.
    println!("cargo:rustc-check-cfg=cfg(rust_analyzer)");
    if env::var("CARGO_CFG_TARGET_OS").is_ok_and(|os| os == "none") {
        for argument in ["-Tlink.x", "-Tdefmt.x", "-Tembedded-test.x", "--nmagic"] {
            println!("cargo:rustc-link-arg-tests={argument}");
        }
    }
}
