//! Finds a toolchain for the boards: the target's library from rustup, or offline Debian's packages `rustc-web` and
//! `rust-web-src`, with the library's source.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Error;

pub const TARGET: &str = "thumbv7em-none-eabihf";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

pub struct Toolchain {
    pub name: String,
    pub arguments: &'static [&'static str],
    pub variables: Vec<(&'static str, OsString)>,
}

/// The available toolchain.
///
/// # Errors
/// None: what to install.
pub fn find() -> Result<Toolchain, Error> {
    let rustc = env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let libraries = ask(&rustc, &["--print", "target-libdir", "--target", TARGET]).map(PathBuf::from);
    if libraries.is_some_and(|path| holds_core(&path)) {
        return Ok(Toolchain {
            name: format!(
                "{} with rustup's {TARGET}",
                ask(&rustc, &["--version"]).unwrap_or(rustc)
            ),
            arguments: &[],
            variables: Vec::new(),
        });
    }
    if let Some(toolchain) = debian(&rustc) {
        return Ok(toolchain);
    }
    Err(format!(
        "nothing here compiles for {TARGET}. Install one of\n  \
         rustup target add {TARGET}\n  \
         apt-get install rustc-web rust-web-src     (Debian, beside a rustup toolchain)"
    )
    .into())
}

fn debian(rustc: &str) -> Option<Toolchain> {
    let version = ask(DEBIAN_RUSTC, &["--version"])?;
    let sysroot = PathBuf::from(ask(DEBIAN_RUSTC, &["--print", "sysroot"])?);
    if !sysroot.join("lib/rustlib/src/rust/library/core").is_dir() {
        return None;
    }
    // Debian's compiler lacks the target's linker; every rustup toolchain has one.
    let host = ask(rustc, &["-vV"])?
        .lines()
        .find_map(|l| l.strip_prefix("host: ").map(str::to_string))?;
    let linkers = PathBuf::from(ask(rustc, &["--print", "sysroot"])?)
        .join("lib/rustlib")
        .join(host)
        .join("bin");
    if !linkers.join("rust-lld").is_file() {
        return None;
    }
    let path = env::var_os("PATH").unwrap_or_default();
    let path = env::join_paths(std::iter::once(linkers).chain(env::split_paths(&path))).ok()?;
    Some(Toolchain {
        name: format!("Debian's {version}, building `core` from its source"),
        // Not in .cargo/config.toml, which would also affect host builds with a nightly cargo.
        arguments: &["-Zbuild-std=core"],
        variables: vec![
            ("RUSTC", DEBIAN_RUSTC.into()),
            // Lets a released cargo build the library.
            ("RUSTC_BOOTSTRAP", "1".into()),
            ("PATH", path),
        ],
    })
}

fn ask(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_string())
}

/// Whether it holds a compiled `core`.
fn holds_core(folder: &Path) -> bool {
    folder.read_dir().is_ok_and(|entries| {
        entries.flatten().any(|entry| {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            name.starts_with("libcore-") && name.ends_with(".rlib")
        })
    })
}
