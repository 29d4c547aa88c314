//! Reads the board's barometer at 25 Hz.
//!
//! Runs in the background: a measurement takes some tens of milliseconds, in which the task waits, and its bus may stall.
//! Without one the link turns stale, and the height is held as on a board without the part.

use embassy_time::{Duration, Instant, with_timeout};

use crate::deadline::{FixedRate, TaskId};
use crate::links::{AirPressure, Links};
use crate::ports::Barometer;

/// Limit of one reading: most of a period, after which the next one begins.
pub const READING: Duration = Duration::from_millis(36);

/// Reads the barometer; never returns. A failing one sends nothing.
pub async fn run(links: &Links, mut port: impl Barometer) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Barometer);
    loop {
        rate.next().await;
        let reading = with_timeout(READING, port.read()).await;
        let reading = reading.ok().and_then(Result::ok);
        if let Some(air) = reading.and_then(AirPressure::checked) {
            links.air_pressure.send(Instant::from_micros(air.at_us), air);
        }
    }
}
