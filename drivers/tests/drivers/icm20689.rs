//! The ICM-20689 driver on a fake part; icm42688p.rs tests what both share.

use super::fake::run;
use super::fake::spi::{Bus, DataReady, Failure, Kind, Part};
use embassy_time::{Duration, Instant, with_timeout};
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::params::Params;
use sophie_drivers::fault::{Fault, Sensor};
use sophie_drivers::icm20689::{Config, GyroFilter, Icm20689};
use sophie_drivers::mounting::Mounting;
use sophie_ports::sensors::Imu;

#[test]
fn it_is_configured_and_read_at_4_khz() {
    run(async {
        let part = Part::new(Kind::Icm20689);
        let mut driver = Icm20689::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            Config::default(),
            Mounting::default(),
        );
        driver.init().await.unwrap();
        let took = Instant::now().as_millis();
        assert!((180..200).contains(&took), "{took} ms");
        {
            let part = part.borrow();
            let b0 = part.banks[0];
            assert_eq!(part.writes.first(), Some(&(0, 0x6B, 0x80)));
            assert_eq!(b0[0x19..0x1E], [0x00, 0x00, 0x18, 0x18, 0x00]);
            assert_eq!(
                (b0[0x37], b0[0x38], b0[0x6A] & 0x10, b0[0x6B], b0[0x6C]),
                (0, 1, 0x10, 1, 0)
            );
            assert_eq!(part.violations, Vec::<String>::new());
        }
        assert!((driver.rate_hz() - 4000.0).abs() < 0.1);
        part.borrow_mut().gyro = [10.0, 20.0, 30.0];
        part.borrow_mut().transactions.clear();
        let start = Instant::now();
        let mut last = None;
        for _ in 0..4000 {
            last = Some(driver.read().await.unwrap()[0]);
        }
        let took = (Instant::now() - start).as_millis();
        assert!((995..=1005).contains(&took), "{took} ms for 4000 samples");
        // The first sample only proves a change.
        let bursts = part.borrow().transactions.iter().filter(|&&n| n == 15).count();
        assert_eq!(bursts, 4001);
        let reading = last.unwrap();
        assert!(
            (reading.gyro.x.to_degrees() - 10.0).abs() < 0.15,
            "{:?}",
            reading.gyro
        );
        assert!(
            (reading.gyro.z.to_degrees() + 30.0).abs() < 0.15,
            "{:?}",
            reading.gyro
        );
        assert!((reading.accel.z + GRAVITY).abs() < 0.02, "{:?}", reading.accel);
        assert!((driver.temperature() - 35.0).abs() < 0.01);
    });
}

#[test]
fn at_1_khz_every_pulse_is_read() {
    run(async {
        let part = Part::new(Kind::Icm20689);
        let config = Config {
            gyro_filter: GyroFilter::Hz176,
            read_every: 1,
            ..Config::default()
        };
        let mut driver = Icm20689::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            config,
            Mounting::default(),
        );
        driver.init().await.unwrap();
        assert!((driver.rate_hz() - 1000.0).abs() < 0.1);
        let start = Instant::now();
        for _ in 0..100 {
            driver.read().await.unwrap();
        }
        let took = (Instant::now() - start).as_millis();
        assert!((99..=101).contains(&took), "{took} ms");
    });
}

#[test]
fn another_part_in_its_place_is_named() {
    run(async {
        let part = Part::new(Kind::Icm42688p);
        let mut driver = Icm20689::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            Config::default(),
            Mounting::default(),
        );
        assert_eq!(
            driver.init().await,
            Err(Fault::Identity {
                expected: 0x98,
                found: 0x47
            })
        );
    });
}

#[test]
fn the_self_test_passes_and_fails_by_axis() {
    run(async {
        let part = Part::new(Kind::Icm20689);
        let mut driver = Icm20689::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            Config::default(),
            Mounting::default(),
        );
        let report = driver.self_test().await.unwrap();
        assert!(
            report
                .gyro
                .iter()
                .chain(&report.accel)
                .all(|p| (98..=102).contains(p)),
            "{report:?}"
        );
        assert_eq!(
            part.borrow().banks[0][0x1B..0x1D],
            [0x18, 0x18],
            "ranges restored, actuation off"
        );
        part.borrow_mut().health[0] = 0.4;
        let fault = driver.self_test().await.unwrap_err();
        assert!(
            matches!(
                fault,
                Fault::SelfTest {
                    sensor: Sensor::Gyro,
                    axis: 0,
                    ..
                }
            ),
            "{fault:?}"
        );
    });
}

#[test]
fn a_lost_part_comes_back_although_its_reset_is_longer_than_the_task_waits() {
    run(async {
        let part = Part::new(Kind::Icm20689);
        let mut driver = Icm20689::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            Config::default(),
            Mounting::default(),
        );
        driver.init().await.unwrap();
        driver.read().await.unwrap();
        part.borrow_mut().failure = Failure::Mute;
        for _ in 0..10 {
            assert!(!matches!(
                with_timeout(Duration::from_millis(3), driver.read()).await,
                Ok(Ok(_))
            ));
        }
        part.borrow_mut().failure = Failure::None;
        let start = Instant::now();
        while !matches!(
            with_timeout(Duration::from_millis(3), driver.read()).await,
            Ok(Ok(_))
        ) {}
        let took = (Instant::now() - start).as_millis();
        assert!(took < 400, "{took} ms");
    });
}

#[test]
fn the_parameters_set_rate_and_ranges_and_the_scales_follow() {
    for rate in [1000.0, 2000.0, 4000.0, 8000.0] {
        for (dps, gyro) in [(250.0, 0u8), (500.0, 1), (1000.0, 2), (2000.0, 3)] {
            for (g, accel) in [(2.0, 0u8), (4.0, 1), (8.0, 2), (16.0, 3)] {
                let mut params = Params::default();
                params.set("imu_rate", rate).unwrap();
                params.set("imu_gyro_range", dps).unwrap();
                params.set("imu_accel_range", g).unwrap();
                run(async move {
                    let part = Part::new(Kind::Icm20689);
                    let mut driver = Icm20689::new(
                        Bus(part.clone()),
                        DataReady(part.clone()),
                        Config::from_params(&params),
                        Mounting::default(),
                    );
                    driver.init().await.unwrap();
                    // The 250 Hz filter at 8 kHz at every rate: no divider, no slower filter.
                    let b0 = part.borrow().banks[0];
                    assert_eq!(b0[0x19..0x1E], [0x00, 0x00, gyro << 3, accel << 3, 0x00]);
                    assert!((driver.rate_hz() - rate).abs() < 0.1);
                    {
                        let mut part = part.borrow_mut();
                        part.gyro = [0.5 * dps, 0.0, 0.0];
                        part.accel = [0.5 * g, 0.0, 1.0];
                    }
                    driver.read().await.unwrap();
                    let start = Instant::now();
                    let mut last = None;
                    for _ in 0..100 {
                        last = Some(driver.read().await.unwrap()[0]);
                    }
                    let took = (Instant::now() - start).as_micros() as f32;
                    assert!((took * rate * 1e-8 - 1.0).abs() < 0.02, "{took} us at {rate} Hz");
                    let last = last.unwrap();
                    assert!(
                        (last.gyro.x.to_degrees() - 0.5 * dps).abs() < 3.0 * dps / 32768.0,
                        "{last:?}"
                    );
                    assert!(
                        (last.accel.x - 0.5 * g * GRAVITY).abs() < 3.0 * g * GRAVITY / 32768.0,
                        "{last:?}"
                    );
                });
            }
        }
    }
}
