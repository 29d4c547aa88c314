//! The watchdog bites a board that does not feed it, in the time for which the supervisor is written, and the memory that
//! must outlive it does. Its clock is no crystal's: a factor of two in the board's clocks would show.

use core::ops::RangeInclusive;

use embassy_futures::block_on;
use sophie_rig::keep_alive;

/// From the last meal to the reset, µs: 300 ms by 32 kHz, of a clock that may have 17 to 47 kHz (datasheets of the F4 and
/// F7, LSI).
const BITE: RangeInclusive<u32> = 200_000..=570_000;

/// The second half, after the reset: `us` is when the first one was heard of last.
pub fn bitten(us: u32) -> ! {
    // The log wants the time base.
    let board = block_on(sophie_boards::take());
    keep_alive(board.watchdog);
    defmt::info!("the watchdog bit after {=u32} us", us);
    assert!(BITE.contains(&us), "the watchdog bit after {us} us");
    sophie_rig::passed()
}

#[embedded_test::tests]
mod tests {
    use embassy_time::{Instant, Timer};
    use sophie_rig::resumable_test::{ResumableTest, leave};
    use sophie_tasks::ports::Watchdog;

    #[test]
    async fn it_bites_a_board_that_stands_still() {
        // Taking the board starts the watchdog, from its longest count: only a meal gives it the board's period, some
        // cycles of its slow clock after the start.
        let mut board = sophie_boards::take().await;
        Timer::after_millis(5).await;
        board.watchdog.feed();
        let start = Instant::now();
        loop {
            let us = start.elapsed().as_micros() as u32;
            leave(ResumableTest::Starving(us));
            assert!(us < 2 * super::BITE.end(), "the watchdog never bit");
            Timer::after_micros(500).await;
        }
    }
}
