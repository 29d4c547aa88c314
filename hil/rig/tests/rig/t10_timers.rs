//! The time base's alarms, and the levels.

#[embedded_test::tests]
mod tests {
    use core::sync::atomic::{AtomicU32, Ordering};

    use embassy_time::{Duration, Instant, Ticker, Timer};
    use sophie_rig::keep_alive;

    const PERIOD: Duration = Duration::from_millis(1);
    /// Latest alarm in an idle processor, µs; the fastest task's period is 1000.
    const LATE_MAX: u32 = 20;

    static BEATS: AtomicU32 = AtomicU32::new(0);
    static WORST: AtomicU32 = AtomicU32::new(0);

    #[test]
    async fn a_millisecond_lasts_a_millisecond() {
        // Drops the other ports: held over a wait, they take 1.2 KiB of RAM.
        keep_alive(sophie_boards::take().await.watchdog);
        let worst = worst_lateness(1000).await;
        defmt::info!("alarms: {=u32} us late at worst", worst);
        assert!(worst <= LATE_MAX, "an alarm came {worst} us late");
    }

    #[test]
    async fn the_flight_level_preempts_the_background() {
        let flight = keep_alive(sophie_boards::take().await.watchdog);
        flight.spawn(defmt::unwrap!(beat().ok()));
        Timer::after(PERIOD).await;
        let (start, before) = (Instant::now(), BEATS.load(Ordering::Relaxed));
        while start.elapsed() < PERIOD * 100 {}
        let beats = BEATS.load(Ordering::Relaxed) - before;
        let worst = WORST.load(Ordering::Relaxed);
        defmt::info!("flight level: {=u32} us late at worst", worst);
        assert!((99..=101).contains(&beats), "{beats} beats in 100 ms");
        assert!(worst <= LATE_MAX, "a beat came {worst} us late");
    }

    #[embassy_executor::task]
    async fn beat() {
        loop {
            let late = worst_lateness(1).await;
            BEATS.fetch_add(1, Ordering::Relaxed);
            WORST.fetch_max(late, Ordering::Relaxed);
        }
    }

    async fn worst_lateness(periods: u32) -> u32 {
        let start = Instant::now();
        let mut ticker = Ticker::every(PERIOD);
        let mut worst = 0;
        for nth in 1..=periods {
            ticker.next().await;
            worst = worst.max((Instant::now() - (start + PERIOD * nth)).as_micros() as u32);
        }
        worst
    }
}
