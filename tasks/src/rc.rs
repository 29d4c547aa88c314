//! The receiver: bytes in, the pilot's wishes out.
//!
//! CRSF or SBUS, as the parameter `rc_protocol` says; 50 to 500 frames a second. A frame that is broken, or
//! whose channels no transmitter sends on purpose, is counted and otherwise as if it had not come: the link then
//! turns stale by itself. So it does when the receiver says that it has lost its transmitter, and when the line
//! speaks the other protocol.

use embassy_time::{Duration, Instant, Timer};

use crate::deadline::{TaskId, record_run};
use crate::links::Links;
use crate::ports::{RcDecoder, SerialInput};

/// Bytes taken at once: two of the longest frames.
const BUFFER: usize = 128;
/// Time from the bytes' arrival by which they must have been decoded.
const DEADLINE: Duration = TaskId::Rc.deadline();
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
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
