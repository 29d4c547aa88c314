//! Shared code of the tests on a real board, run by a probe. `tests/rig/` has the tests, `hil/README.md` the wiring.
//! Empty on the host.
//!
//! The tests use the firmware's board crate: drivers, pins and timers that fly. Each starts from a reset. A missing
//! jumper or part is logged as `ignored:` and passes; with the feature `wired` it fails.

#![cfg_attr(target_os = "none", no_std)]
#![cfg(target_os = "none")]

pub mod cycles;
pub mod pads;
pub mod pulses;
pub mod resumable_test;
mod verdict;

use defmt_rtt as _;
use embassy_executor::SendSpawner;
use embassy_time::{Duration, Ticker};
use sophie_boards::{WatchdogPort, start_levels};
use sophie_ports::chip::Watchdog;
pub use verdict::{absent, passed};

sophie_boards::ends_with!(verdict::end_of_run);

/// Watchdog feed period; the shortest time-out is 200 ms.
const FEED_PERIOD: Duration = Duration::from_millis(50);

/// Starts flight and steady level and feeds the watchdog from the latter; returns the flight level. Called once.
pub fn keep_alive(watchdog: WatchdogPort) -> SendSpawner {
    defmt::info!("{=str}", sophie_boards::NAME);
    resumable_test::leave(resumable_test::ResumableTest::Test);
    let (flight, steady) = start_levels();
    // Fails only in a second call, at which `start_levels` panics.
    if let Ok(feeder) = feed(watchdog) {
        steady.spawn(feeder);
    }
    flight
}

#[embassy_executor::task]
async fn feed(mut watchdog: WatchdogPort) {
    let mut ticker = Ticker::every(FEED_PERIOD);
    loop {
        watchdog.feed();
        ticker.next().await;
    }
}
