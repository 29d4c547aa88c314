//! `cargo xtask flash`, `backup` and `restore` with stand-ins for probe-rs and dfu-util: this binary under their names,
//! first on PATH, with a flash in a file and a record of calls.

#![allow(missing_docs, clippy::unwrap_used)]

#[cfg(unix)]
mod backups;
#[cfg(unix)]
mod bench;
mod chips;
mod fixture;
mod stand_ins;
#[cfg(unix)]
mod usb;

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let name = std::env::args_os().next().unwrap_or_default();
    match Path::new(&name).file_name().and_then(|name| name.to_str()) {
        Some("dfu-util") => return stand_ins::dfu_util(),
        Some("probe-rs") => return stand_ins::probe_rs(),
        _ => {}
    }
    let mut tests = Vec::new();
    #[cfg(unix)]
    {
        tests.extend(usb::tests());
        tests.extend(backups::tests());
    }
    libtest_mimic::run(&libtest_mimic::Arguments::from_args(), std::mem::take(&mut tests)).exit_code()
}
