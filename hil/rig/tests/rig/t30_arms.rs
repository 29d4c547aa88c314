//! The arms' sensors: those plugged in identify themselves, run, and measure gravity at rest.

#[embedded_test::tests]
mod tests {
    use embassy_time::{Duration, Instant, Timer};
    use sophie_ports::error::PortError;
    use sophie_ports::sensors::ArmImus;
    use sophie_rig::{absent, keep_alive};

    /// Reset, configuration, and rest for the gyroscope's calibration.
    const START_UP: Duration = Duration::from_secs(10);

    #[test]
    async fn every_sensor_that_is_plugged_in_feels_gravity() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let mut gravity = [Err(PortError::Absent); 4];
        let start = Instant::now();
        while start.elapsed() < START_UP && gravity.iter().any(Result::is_err) {
            for (arm, gravity) in gravity.iter_mut().enumerate() {
                if gravity.is_err() {
                    *gravity = board.arms.gravity(arm).await;
                }
            }
            Timer::after_millis(10).await;
        }
        for (arm, gravity) in gravity.into_iter().enumerate() {
            match (gravity, board.arms.last_fault(arm)) {
                (Ok(g), _) => {
                    defmt::info!(
                        "arm {=usize}: gravity {=f32} {=f32} {=f32}",
                        arm + 1,
                        g.x,
                        g.y,
                        g.z
                    );
                    // 9.8 m/s² within 5 %.
                    assert!((86.0..106.0).contains(&g.norm_squared()), "arm {}", arm + 1);
                }
                (Err(_), Some(sophie_drivers::fault::Fault::Bus | sophie_drivers::fault::Fault::Silent)) => {
                    let address = 0x28 + arm % 2;
                    absent(format_args!("BNO055 of arm {} at {address:#x}", arm + 1));
                }
                (Err(error), fault) => panic!("arm {}: {error:?}, {fault:?}", arm + 1),
            }
        }
    }
}
