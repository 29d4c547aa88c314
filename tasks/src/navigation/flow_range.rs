//! Decodes optical flow and range from the bytes of the sensor module's line.
//!
//! Bytes outside valid frames are dropped; without valid frames the link turns stale.

use embassy_time::{Duration, Instant, Timer};

use crate::deadline::record_run;
use crate::links::Links;
use crate::schedule::TaskId;
use sophie_ports::sensors::GroundDecoder;
use sophie_ports::serial::SerialInput;

/// Bytes per read: both frames of a module.
const BUFFER: usize = 32;
/// From the bytes' arrival.
const DEADLINE: Duration = TaskId::Ground.deadline();
/// Pause after an error or an empty read: a dead line must not take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// Decodes frames; never returns.
pub async fn run(links: &Links, mut port: impl SerialInput, mut decoder: impl GroundDecoder) -> ! {
    let mut buffer = [0; BUFFER];
    loop {
        let count = match port.read(&mut buffer).await {
            Ok(count) if count > 0 => count,
            read => {
                if read.is_err() {
                    decoder.broken();
                }
                Timer::after(PAUSE).await;
                continue;
            }
        };
        let at = Instant::now();
        if let Some(view) = decoder.take(buffer.get(..count).unwrap_or_default(), at) {
            links.ground.send(at, view);
        }
        record_run(links, TaskId::Ground, at, at, DEADLINE);
    }
}
