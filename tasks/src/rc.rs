//! The receiver: bytes in, the pilot's wishes out.
//!
//! CRSF or SBUS, as the parameter `receiver_protocol` says; 50 to 500 frames a second. A frame that is broken, or
//! whose channels no transmitter sends on purpose, is counted and otherwise as if it had not come: the link then
//! turns stale by itself. So it does when the receiver says that it has lost its transmitter, and when the line
//! speaks the other protocol.

mod crsf;
pub mod sbus;

use embassy_time::{Duration, Instant, Timer};
use sophie_control::params::Params;

use crate::deadline::{TaskId, record_run};
use crate::links::{Links, RcState};
use crate::ports::SerialInput;

/// Bytes taken at once: two of the longest frames.
const BUFFER: usize = 128;
/// Time from the bytes' arrival by which they must have been decoded.
const DEADLINE: Duration = TaskId::Rc.deadline();
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// What the receiver speaks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Protocol {
    /// CRSF: 420 kbaud, 8N1, telemetry back to the pilot on the other line.
    #[default]
    Crsf,
    /// SBUS: 100 kbaud, 8E2, inverted, no way back.
    Sbus,
}

impl Protocol {
    /// As the parameters say.
    pub fn from_params(p: &Params) -> Self {
        if p.receiver_protocol < 0.5 {
            Self::Crsf
        } else {
            Self::Sbus
        }
    }
}

/// Frames and counts out of a stream of bytes, however it is cut.
trait Decode {
    /// Takes bytes that were there at `at`; gives the state when they held at least one good frame of channels and
    /// the radio is not known to be lost.
    fn take(&mut self, bytes: &[u8], at: Instant) -> Option<RcState>;

    /// The line has failed at `at`: bytes are missing.
    fn broken(&mut self, at: Instant);
}

/// Decodes frames; never returns.
pub async fn run(links: &Links, port: impl SerialInput) -> ! {
    match Protocol::from_params(&links.params) {
        Protocol::Crsf => serve(links, port, crsf::Decoder::new()).await,
        Protocol::Sbus => serve(links, port, sbus::Decoder::new()).await,
    }
}

async fn serve(links: &Links, mut port: impl SerialInput, mut decoder: impl Decode) -> ! {
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
