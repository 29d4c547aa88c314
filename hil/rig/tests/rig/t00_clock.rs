//! The core's clock against the time base: dividers of their own from one crystal. That the crystal is the one that the
//! board expects shows where another oscillator comes in: the inertial sensor's (`t20_imu`), the watchdog's
//! (`t70_watchdog`).

#[embedded_test::tests]
mod tests {
    use embassy_time::{Duration, Instant};
    use sophie_rig::pads::WIRING;
    use sophie_rig::{board, cycles, keep_alive};

    /// Measured for this long; a tick of the time base is 1 µs.
    const SPAN: Duration = Duration::from_millis(100);

    #[test]
    async fn the_core_runs_at_its_clock() {
        let board = board::take().await;
        keep_alive(board.watchdog);
        let (start, first) = (Instant::now(), cycles::now());
        while start.elapsed() < SPAN {}
        let (us, cycles) = (start.elapsed().as_micros(), cycles::now().wrapping_sub(first));
        let hz = u64::from(cycles) * 1_000_000 / us;
        defmt::info!("core: {=u64} Hz by the time base", hz);
        assert!(
            hz.abs_diff(u64::from(WIRING.core_hz)) < u64::from(WIRING.core_hz) / 1000,
            "{hz} Hz instead of {}",
            WIRING.core_hz
        );
    }
}
