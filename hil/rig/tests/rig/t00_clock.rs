//! Core clock against time base, divided from one crystal, and time base against itself. A wrong crystal shows only
//! against the inertial sensor (`t20_imu`) and the watchdog (`t70_watchdog`).

#[embedded_test::tests]
mod tests {
    use embassy_time::{Duration, Instant};
    use sophie_boards::WIRING;
    use sophie_rig::{cycles, keep_alive};

    /// Measuring time; a tick of the time base is 1 µs.
    const SPAN: Duration = Duration::from_millis(100);
    /// Two half turns of the 16-bit counter, 32.8 ms each.
    const TURN: Duration = Duration::from_millis(70);
    /// Longest delay of the half-turn interrupt.
    const WAIT: u32 = 100;

    #[test]
    async fn the_core_runs_at_its_clock() {
        let board = sophie_boards::take().await;
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
    /// Nor while its interrupt waits: the flight level reads it in interrupts.
    #[test]
    async fn the_time_base_never_runs_back() {
        let board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let (start, mut before) = (Instant::now(), Instant::now());
        while before - start < TURN {
            critical_section::with(|_| {
                let masked = before;
                while before.saturating_duration_since(masked).as_micros() < u64::from(WAIT) {
                    let now = Instant::now();
                    assert!(
                        now >= before,
                        "{} us after {} us",
                        now.as_micros(),
                        before.as_micros()
                    );
                    before = now;
                }
            });
        }
    }
}
