//! The watchdog resets an unfed board in time, and retained memory survives. Its clock has no crystal: a factor of two
//! in the board's clocks would show.

use core::ops::RangeInclusive;

use embassy_futures::block_on;
use sophie_rig::keep_alive;

/// Last feed to reset, µs: 300 ms at 32 kHz, from a clock of 17 to 47 kHz (datasheets of the F4 and F7, LSI).
const TIMEOUT_US: RangeInclusive<u32> = 200_000..=570_000;

/// After the reset; `us`: last time recorded before.
pub fn bitten(us: u32) -> ! {
    // The log needs the time base.
    let board = block_on(sophie_boards::take());
    keep_alive(board.watchdog);
    defmt::info!("the watchdog reset it after {=u32} us", us);
    assert!(TIMEOUT_US.contains(&us), "the watchdog reset it after {us} us");
    sophie_rig::passed()
}

#[embedded_test::tests]
mod tests {
    use embassy_time::{Instant, Timer};
    use sophie_ports::chip::Watchdog;
    use sophie_rig::resumable_test::{ResumableTest, leave};

    #[test]
    async fn it_resets_a_board_that_stands_still() {
        // Taking the board starts the watchdog at its longest count: a feed sets the board's period, some cycles of its
        // slow clock after the start.
        let mut board = sophie_boards::take().await;
        Timer::after_millis(5).await;
        board.watchdog.feed();
        let start = Instant::now();
        loop {
            let us = start.elapsed().as_micros() as u32;
            leave(ResumableTest::Starving(us));
            assert!(us < 2 * super::TIMEOUT_US.end(), "the watchdog never reset it");
            Timer::after_micros(500).await;
        }
    }
}
