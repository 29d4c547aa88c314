//! Ctrl-C as a flag, so that a running command ends in order.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

/// Exit status after a second Ctrl-C, the same as a shell's.
const INTERRUPTED: i32 = 130;

/// A flag that Ctrl-C or SIGTERM raises; a second signal ends the process.
///
/// # Errors
/// One line: signals cannot be caught.
pub fn on_ctrl_c() -> Result<Arc<AtomicBool>, String> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order, the handler of the first signal sees the flag still down.
        flag::register_conditional_shutdown(signal, INTERRUPTED, Arc::clone(&stop))
            .and_then(|_| flag::register(signal, Arc::clone(&stop)))
            .map_err(|why| format!("Ctrl-C cannot be caught: {why}"))?;
    }
    Ok(stop)
}
