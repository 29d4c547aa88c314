//! Receiver: decodes bytes to the pilot's sticks.
//!
//! CRSF or SBUS by the parameter `rc_protocol`; 50 to 500 frames a second. Invalid frames are counted and dropped;
//! then, and with a lost transmitter or the wrong protocol, the link turns stale.

use embassy_time::{Duration, Instant, Timer};

use crate::deadline::record_run;
use crate::links::Links;
use crate::schedule::TaskId;
use sophie_ports::receiver::RcDecoder;
use sophie_ports::serial::SerialInput;

/// Bytes per read: two of the longest frames.
const BUFFER: usize = 128;
/// From the bytes' arrival.
const DEADLINE: Duration = TaskId::Rc.deadline();
/// Pause after an error or an empty read: a dead line must not take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// Decodes frames; never returns.
pub async fn run(links: &Links, mut port: impl SerialInput, mut decoder: impl RcDecoder) -> ! {
    let mut buffer = [0; BUFFER];
    loop {
        let count = match port.read(&mut buffer).await {
            Ok(count) if count > 0 => count,
            Ok(_) => {
                Timer::after(PAUSE).await;
                continue;
            }
            Err(_) => {
                decoder.broken(Instant::now());
                Timer::after(PAUSE).await;
                continue;
            }
        };
        let at = Instant::now();
        if let Some(state) = decoder.take(buffer.get(..count).unwrap_or_default(), at) {
            links.rc.send(at, state);
        }
        record_run(links, TaskId::Rc, at, at, DEADLINE);
    }
}
