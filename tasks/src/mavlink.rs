//! MAVLink to ground stations and companion computers, over any byte stream.
//!
//! Background: whatever arrives, or stays away, delays nothing that flies. A miss costs a late picture.

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use sophie_mavlink::{Server, Vehicle};

use crate::deadline::{FixedRate, TaskId};
use crate::links::Links;
use crate::ports::{SerialInput, SerialOutput, Storage};

/// Bytes taken at once.
const CHUNK: usize = 64;
/// Pause after a line error or an empty read, so that a dead line cannot take the processor.
const PAUSE: Duration = Duration::from_millis(1);

/// What is known of the line under a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// What the server may send, bytes each second: less than the line carries.
    pub bytes_per_second: u32,
}

/// Serves MAVLink on one line; never returns. `restart` restarts the board.
pub async fn run(
    links: &Links,
    mut input: impl SerialInput,
    mut output: impl SerialOutput,
    _storage: impl Storage,
    _restart: impl FnMut(),
    _line: Line,
) -> ! {
    let mut server = Server::new();
    let mut rate = FixedRate::of(links, TaskId::Mavlink);
    let mut bytes = [0; CHUNK];
    loop {
        let tick = {
            let next = rate.next();
            let mut next = core::pin::pin!(next);
            loop {
                match select(next.as_mut(), input.read(&mut bytes)).await {
                    Either::First(tick) => break tick,
                    Either::Second(Ok(count)) if count > 0 => {
                        server.receive(bytes.get(..count).unwrap_or_default(), Instant::now().as_micros());
                    }
                    Either::Second(_) => Timer::after(PAUSE).await,
                }
            }
        };
        let vehicle = picture(links);
        while let Some(frame) = server.send(tick.started.as_micros(), &vehicle) {
            // A frame that the line does not take is lost; the next one follows.
            let _ = output.write(frame).await;
        }
    }
}

/// What the links say now.
fn picture(links: &Links) -> Vehicle {
    Vehicle {
        mode: links.status.fresh().map(|status| status.mode),
    }
}
