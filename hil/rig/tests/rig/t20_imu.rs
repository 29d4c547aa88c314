//! The inertial sensor. Its oscillator is good to 1 or 2 %, so a wrong crystal shows in its sample rate. The board lies
//! still, in any orientation.

#[embedded_test::tests]
mod tests {
    use embassy_time::{Duration, Instant, with_timeout};
    use sophie_ports::sensors::Imu;
    use sophie_rig::keep_alive;

    /// From the first call to samples.
    const START_UP: Duration = Duration::from_secs(2);
    const SPAN: Duration = Duration::from_secs(1);

    async fn first(imu: &mut sophie_boards::ImuPort) -> sophie_control::chain::ImuReading {
        let mut last = Err(sophie_ports::error::PortError::Timeout);
        let start = Instant::now();
        while start.elapsed() < START_UP {
            if let Ok(read) = with_timeout(START_UP, imu.read()).await {
                last = read;
            }
            if let Ok(samples) = &last
                && let Some(&sample) = samples.first()
            {
                return sample;
            }
        }
        panic!("no sample: {:?}", last.err())
    }

    /// The driver checks WHO_AM_I and reads back every register before it samples.
    #[test]
    async fn it_answers_by_its_name_and_feels_gravity() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        let sample = first(&mut board.imu).await;
        let (force, rate) = (sample.accel.norm_squared(), sample.gyro.norm_squared());
        defmt::info!(
            "specific force squared: {=f32}, rate squared: {=f32}",
            force,
            rate
        );
        // 9.8 m/s² within 10 %, and less than 20 °/s.
        assert!((78.0..116.0).contains(&force), "{force} (m/s2)^2 at rest");
        assert!(rate < 0.12, "{rate} (rad/s)^2 at rest");
    }

    #[test]
    async fn samples_come_at_their_rate() {
        let mut board = sophie_boards::take().await;
        keep_alive(board.watchdog);
        first(&mut board.imu).await;
        let (start, mut count) = (Instant::now(), 0u32);
        while start.elapsed() < SPAN {
            match board.imu.read().await {
                Ok(samples) => count += samples.len() as u32,
                Err(error) => panic!("{error:?} after {count} samples"),
            }
        }
        let hz = f64::from(count) * 1e6 / start.elapsed().as_micros() as f64;
        let nominal = f64::from(board.imu.rate_hz());
        defmt::info!("inertial sensor: {=f64} Hz of {=f64}", hz, nominal);
        assert!((hz / nominal - 1.0).abs() < 0.02, "{hz} Hz instead of {nominal}");
    }
}
