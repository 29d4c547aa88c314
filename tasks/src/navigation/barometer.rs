//! Reads the board's barometer at 25 Hz.
//!
//! Runs in the background: the task waits some tens of milliseconds for a measurement, and its bus may stall. After a
//! failure the link turns stale, and the height is estimated as on a board without a barometer.

use embassy_time::{Instant, with_timeout};
use sophie_ports::sensors::BAROMETER_READING;

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::schedule::TaskId;
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_ports::sensors::Barometer;

/// Reads the barometer; never returns. A failed reading sends nothing.
pub async fn run(links: &Links, mut port: impl Barometer) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Barometer);
    loop {
        rate.next().await;
        let reading = with_timeout(BAROMETER_READING, port.read()).await;
        let reading = reading.ok().and_then(Result::ok);
        if let Some(air) = reading.and_then(AirPressure::checked) {
            links.air_pressure.send(Instant::from_micros(air.at_us), air);
        }
    }
}
