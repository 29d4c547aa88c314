//! The console: a line for builders, over any terminal program at 115,200 baud. Background level.

use crate::links::Links;
use crate::ports::{Restart, SerialInput, SerialOutput, Storage};

/// Serves the console for ever.
pub async fn run(
    links: &Links,
    input: impl SerialInput,
    output: impl SerialOutput,
    storage: impl Storage,
    restart: impl Restart,
) -> ! {
    let _ = (links, input, output, storage, restart);
    core::future::pending().await
}
