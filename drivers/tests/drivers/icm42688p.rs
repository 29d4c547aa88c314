//! The ICM-42688-P driver on a fake part.

use std::cell::RefCell;
use std::rc::Rc;

use super::fake::run;
use super::fake::spi::{Bus, DataReady, Failure, Kind, Part};
use embassy_time::{Duration, Instant, Timer, with_timeout};
use sophie_control::chain::ImuReading;
use sophie_control::maths::scalar::GRAVITY;
use sophie_control::maths::vector::Vec3;
use sophie_control::params::{ImuAccelRange, ImuGyroRange, ImuRate, Params};
use sophie_drivers::fault::{Fault, Sensor};
use sophie_drivers::icm42688p::{AntiAlias, Config, FilterOrder, Icm42688p};
use sophie_drivers::mounting::{Heading, Mounting};
use sophie_ports::error::PortError;
use sophie_ports::sensors::Imu;

type Driver = Icm42688p<Bus, DataReady>;
type Shared = Rc<RefCell<Part>>;
type Spoil = fn(&mut Part);

fn pair(config: Config) -> (Driver, Shared) {
    let part = Part::new(Kind::Icm42688p);
    (
        Driver::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            config,
            Mounting::default(),
        ),
        part,
    )
}

async fn read(driver: &mut Driver) -> Option<Result<ImuReading, PortError>> {
    let batch = with_timeout(Duration::from_millis(3), driver.read()).await.ok()?;
    Some(batch.map(|b| b[0]))
}

async fn read_for(driver: &mut Driver, time: Duration) -> (u32, Vec<PortError>, Instant) {
    let end = Instant::now() + time;
    let (mut good, mut errors, mut last) = (0, Vec::new(), Instant::from_ticks(0));
    while Instant::now() < end {
        match read(driver).await {
            Some(Ok(_)) => {
                good += 1;
                last = Instant::now();
            }
            Some(Err(error)) => errors.push(error),
            None => (),
        }
    }
    (good, errors, last)
}

#[test]
fn the_default_configuration_is_what_the_datasheet_asks_for() {
    let (took, part) = run(async {
        let (mut driver, part) = pair(Config::default());
        driver.init().await.unwrap();
        (Instant::now().as_millis(), part)
    });
    let part = part.borrow();
    assert_eq!(part.violations, Vec::<String>::new());
    assert_eq!(part.writes.first(), Some(&(0, 0x11, 0x01)), "reset first");
    assert_eq!(part.writes.last(), Some(&(0, 0x4E, 0x0F)), "power last");
    let expected = [
        (0, 0x14, 0x03), // INT1 pulsed, push-pull, high
        (0, 0x4C, 0x33), // big-endian, I2C off
        (0, 0x4D, 0x51), // adaptive full scale off, PLL
        (0, 0x4F, 0x04), // 2000 °/s, 4 kHz
        (0, 0x50, 0x04), // 16 g, 4 kHz
        (0, 0x51, 0x12), // first order
        (0, 0x52, 0x11),
        (0, 0x53, 0x05),
        (0, 0x64, 0x60), // 8 µs pulses, async reset off
        (0, 0x65, 0x08), // data-ready to INT1
        (1, 0x0B, 0xA0), // filters on
        (1, 0x0C, 0x0D), // 585 Hz
        (1, 0x0D, 0xAA),
        (1, 0x0E, 0x80),
        (2, 0x03, 0x1A),
        (2, 0x04, 0xAA),
        (2, 0x05, 0x80),
    ];
    for (bank, register, value) in expected {
        let found = part.banks[bank][register];
        assert_eq!(found, value, "bank {bank} 0x{register:02X}: 0x{found:02X}");
    }
    assert!((47..60).contains(&took), "{took} ms");
}

#[test]
fn every_choice_reaches_its_register() {
    let config = Config {
        gyro_range: ImuGyroRange::Dps500,
        accel_range: ImuAccelRange::G8,
        rate: ImuRate::Hz8000,
        filter_order: FilterOrder::Third,
        gyro_anti_alias: AntiAlias::Hz1962,
        accel_anti_alias: AntiAlias::Off,
        ..Config::default()
    };
    let part = run(async move {
        let (mut driver, part) = pair(config);
        driver.init().await.unwrap();
        assert!((driver.rate_hz() - 8000.0).abs() < 0.1);
        part
    });
    let part = part.borrow();
    let b0 = part.banks[0];
    assert_eq!((b0[0x4F], b0[0x50], b0[0x51], b0[0x53]), (0x43, 0x23, 0x1A, 0x15));
    // 1962 Hz: 37, 1376 = 0x560, 4.
    assert_eq!(part.banks[1][0x0C..0x0F], [37, 0x60, 0x45]);
    assert_eq!(part.banks[2][0x03] & 1, 1);
}

#[test]
fn samples_come_at_4_khz_in_body_axes_one_burst_each() {
    run(async {
        let part = Part::new(Kind::Icm42688p);
        // The part's x is body y, its y is body x.
        let mounting = Mounting::top_up(Heading::Right);
        let mut driver = Driver::new(
            Bus(part.clone()),
            DataReady(part.clone()),
            Config::default(),
            mounting,
        );
        driver.init().await.unwrap();
        {
            let mut part = part.borrow_mut();
            part.gyro = [100.0, -50.0, 25.0];
            part.accel = [0.1, 0.2, 1.0];
            part.transactions.clear();
        }
        let reading = read(&mut driver).await.unwrap().unwrap();
        let gyro = Vec3::new(-50.0, 100.0, -25.0).map(f32::to_radians);
        let accel = Vec3::new(0.2, 0.1, -1.0).map(|g| g * GRAVITY);
        assert!((reading.gyro - gyro).norm() < 4e-3, "{:?}", reading.gyro);
        assert!((reading.accel - accel).norm() < 2e-2, "{:?}", reading.accel);
        assert!((driver.temperature() - 35.0).abs() < 0.01);
        assert_eq!(
            part.borrow().transactions,
            [15, 15],
            "the first sample only shows that there are others"
        );

        let (good, errors, _) = read_for(&mut driver, Duration::from_secs(1)).await;
        assert!(
            (3999..=4001).contains(&good) && errors.is_empty(),
            "{good} {errors:?}"
        );
        // Besides samples: ten checks.
        assert_eq!(part.borrow().transactions.len() as u32, 2 + good + 2 * 10);
    });
}

#[test]
fn the_v_of_the_same_part_is_taken_and_named() {
    run(async {
        let (mut driver, part) = pair(Config::default());
        part.borrow_mut().identity = Some(0xDB);
        assert_eq!(driver.name(), "ICM-42688-P");
        driver.init().await.unwrap();
        assert_eq!(driver.name(), "ICM-42688-V");
        let (good, errors, _) = read_for(&mut driver, Duration::from_secs(1)).await;
        assert!(good > 3990 && errors.is_empty(), "{good} {errors:?}");
        // It does not become the other in flight: that is a byte misread.
        part.borrow_mut().banks[0][0x75] = 0x47;
        let (_, errors, _) = read_for(&mut driver, Duration::from_millis(150)).await;
        let misread = Fault::Identity {
            expected: 0xDB,
            found: 0x47,
        };
        assert_eq!(driver.last_fault(), Some(misread), "{errors:?}");
    });
}

#[test]
fn what_is_wrong_at_start_up_is_named() {
    let cases: [(Spoil, Fault, PortError); 6] = [
        (
            |p| p.failure = Failure::Ones,
            Fault::Identity {
                expected: 0x47,
                found: 0xFF,
            },
            PortError::Absent,
        ),
        (
            |p| p.failure = Failure::Zeros,
            Fault::Identity {
                expected: 0x47,
                found: 0x00,
            },
            PortError::Absent,
        ),
        (|p| p.failure = Failure::Bus, Fault::Bus, PortError::Corrupt),
        (
            |p| p.kind = Kind::Icm20689,
            Fault::Identity {
                expected: 0x47,
                found: 0x98,
            },
            PortError::WrongPart,
        ),
        (
            |p| p.deaf.push((1, 0x0C)),
            Fault::Configuration {
                bank: 1,
                register: 0x0C,
                expected: 0x15,
                found: 0x0D,
            },
            PortError::Corrupt,
        ),
        (
            |p| {
                p.deaf.push((0, 0x11));
                p.banks[0][0x4E] = 0x0F;
            },
            Fault::Reset {
                register: 0x4E,
                found: 0x0F,
            },
            PortError::Timeout,
        ),
    ];
    for (spoil, fault, port_error) in cases {
        run(async move {
            let config = Config {
                gyro_anti_alias: AntiAlias::Hz997,
                ..Config::default()
            };
            let (mut driver, part) = pair(config);
            spoil(&mut part.borrow_mut());
            if fault
                == (Fault::Identity {
                    expected: 0x47,
                    found: 0x98,
                })
            {
                part.borrow_mut().reset();
            }
            assert_eq!(driver.init().await, Err(fault));
            assert_eq!(driver.last_fault(), Some(fault));
            assert_eq!(fault.port_error(), port_error);
        });
    }
}

#[test]
fn a_part_that_appears_late_is_taken_up_by_the_task() {
    run(async {
        let (mut driver, part) = pair(Config::default());
        part.borrow_mut().failure = Failure::Ones;
        let (good, errors, _) = read_for(&mut driver, Duration::from_secs(2)).await;
        assert_eq!(good, 0);
        assert!(
            errors.iter().all(|&e| e == PortError::Absent) && !errors.is_empty(),
            "{errors:?}"
        );
        // No busy loop.
        assert!(
            part.borrow().transactions.len() < 100,
            "{}",
            part.borrow().transactions.len()
        );
        part.borrow_mut().failure = Failure::None;
        let (good, ..) = read_for(&mut driver, Duration::from_millis(500)).await;
        assert!(good > 4 * 250, "{good}");
    });
}

#[test]
fn every_failure_in_flight_is_noticed_within_5_ms_and_got_over() {
    for failure in [
        Failure::Zeros,
        Failure::Ones,
        Failure::Bus,
        Failure::Mute,
        Failure::Frozen,
    ] {
        run(async move {
            let (mut driver, part) = pair(Config::default());
            driver.init().await.unwrap();
            let (_, errors, _) = read_for(&mut driver, Duration::from_millis(100)).await;
            assert!(errors.is_empty());
            part.borrow_mut().failure = failure;
            let failed = Instant::now();
            let (_, _, last) = read_for(&mut driver, Duration::from_millis(300)).await;
            let noticed = last.saturating_duration_since(failed);
            assert!(
                noticed < Duration::from_millis(5),
                "{failure:?}: good samples for {} µs",
                noticed.as_micros()
            );
            let expected = match failure {
                Failure::Frozen => Fault::Stuck,
                Failure::Bus => Fault::Bus,
                Failure::Mute => Fault::Silent,
                Failure::Zeros => Fault::Identity {
                    expected: 0x47,
                    found: 0,
                },
                _ => Fault::Identity {
                    expected: 0x47,
                    found: 0xFF,
                },
            };
            // A frozen part answers its resets.
            assert!(
                driver.last_fault() == Some(expected) || failure == Failure::Frozen,
                "{failure:?}: {:?}",
                driver.last_fault()
            );
            assert!(
                part.borrow().transactions.len() < 1500,
                "{failure:?}: no busy loop"
            );
            part.borrow_mut().failure = Failure::None;
            read_for(&mut driver, Duration::from_millis(300)).await;
            let (good, errors, _) = read_for(&mut driver, Duration::from_millis(100)).await;
            assert!(good >= 399 && errors.is_empty(), "{failure:?}: {good} {errors:?}");
            assert_eq!(part.borrow().violations, Vec::<String>::new(), "{failure:?}");
        });
    }
}

#[test]
fn a_brown_out_of_the_part_costs_less_than_70_ms() {
    run(async {
        let (mut driver, part) = pair(Config::default());
        driver.init().await.unwrap();
        read_for(&mut driver, Duration::from_millis(50)).await;
        part.borrow_mut().reset();
        let lost = Instant::now();
        while !matches!(read(&mut driver).await, Some(Ok(_))) {}
        let took = (Instant::now() - lost).as_millis();
        assert!(took < 70, "{took} ms");
        assert!(matches!(
            driver.last_fault(),
            Some(Fault::Configuration { register: 0x4E, .. })
        ));
    });
}

#[test]
fn a_flipped_range_is_noticed_within_100_ms() {
    run(async {
        let (mut driver, part) = pair(Config::default());
        driver.init().await.unwrap();
        read_for(&mut driver, Duration::from_millis(50)).await;
        part.borrow_mut().banks[0][0x4F] ^= 0x20;
        let (_, errors, _) = read_for(&mut driver, Duration::from_millis(200)).await;
        assert_eq!(errors, [PortError::Corrupt]);
        let fault = Fault::Configuration {
            bank: 0,
            register: 0x4F,
            expected: 0x04,
            found: 0x24,
        };
        assert_eq!(driver.last_fault(), Some(fault));
        assert_eq!(part.borrow().banks[0][0x4F], 0x04);
    });
}

#[test]
fn one_garbled_sample_is_refused_and_no_reason_for_a_reset() {
    run(async {
        let (mut driver, part) = pair(Config::default());
        driver.init().await.unwrap();
        read(&mut driver).await;
        part.borrow_mut().failure = Failure::Ones;
        assert_eq!(read(&mut driver).await, Some(Err(PortError::Corrupt)));
        part.borrow_mut().failure = Failure::None;
        let (good, errors, _) = read_for(&mut driver, Duration::from_millis(10)).await;
        assert!(good >= 39 && errors.is_empty(), "{good} {errors:?}");
    });
}

#[test]
fn the_self_test_passes_fails_by_axis_and_restores_the_configuration() {
    run(async {
        let (mut driver, part) = pair(Config::default());
        driver.init().await.unwrap();
        let report = driver.self_test().await.unwrap();
        assert!(
            report
                .gyro
                .iter()
                .chain(&report.accel)
                .all(|p| (98..=102).contains(p)),
            "{report:?}"
        );
        assert_eq!(part.borrow().banks[0][0x70], 0, "actuation is off again");
        assert_eq!(part.borrow().banks[0][0x4F], 0x04);
        assert_eq!(part.borrow().violations, Vec::<String>::new());
        let (good, errors, _) = read_for(&mut driver, Duration::from_millis(100)).await;
        assert!(good >= 399 && errors.is_empty());

        part.borrow_mut().health[4] = 0.1;
        let fault = driver.self_test().await.unwrap_err();
        assert!(
            matches!(
                fault,
                Fault::SelfTest {
                    sensor: Sensor::Accel,
                    axis: 1,
                    percent: 9..=11
                }
            ),
            "{fault:?}"
        );
        assert_eq!(driver.last_fault(), Some(fault));
        part.borrow_mut().health[4] = 1.0;
        part.borrow_mut().gyro = [0.0, 0.0, 30.0];
        assert_eq!(driver.self_test().await, Err(Fault::Offset { axis: 2 }));
        let (good, ..) = read_for(&mut driver, Duration::from_millis(100)).await;
        assert!(good >= 399);
    });
}

#[test]
fn a_call_dropped_at_any_moment_leaves_nothing_half_done() {
    run(async {
        for after in (0..60_000).step_by(37) {
            let (mut driver, part) = pair(Config::default());
            let _ = with_timeout(Duration::from_micros(after), driver.init()).await;
            // Dropped just before switch-on, it restarts.
            if driver.init().await.is_err() {
                driver.init().await.unwrap();
            }
            let reading = read(&mut driver).await.unwrap().unwrap();
            assert!(
                (reading.accel.z + GRAVITY).abs() < 0.02,
                "after {after} µs: {reading:?}"
            );
            assert_eq!(part.borrow().violations, Vec::<String>::new(), "after {after} µs");
            // The same within samples.
            for _ in 0..20 {
                let _ = with_timeout(Duration::from_micros(after % 300), driver.read()).await;
            }
            let (good, errors, _) = read_for(&mut driver, Duration::from_millis(100)).await;
            assert!(good > 100, "after {after} µs: {good} {errors:?}");
        }
    });
}

#[test]
fn nothing_is_used_before_the_part_has_settled() {
    run(async {
        let (mut driver, _part) = pair(Config::default());
        let start = Instant::now();
        while !matches!(read(&mut driver).await, Some(Ok(_))) {}
        let took = Instant::now() - start;
        assert!(took >= Duration::from_millis(45), "{took:?}");
        Timer::after_millis(1).await;
    });
}

#[test]
fn the_parameters_set_rate_and_ranges_and_the_scales_follow() {
    // Parameter, register bits, and a data-ready each period.
    for (rate, odr) in [(1000.0, 6), (2000.0, 5), (4000.0, 4), (8000.0, 3)] {
        for (dps, gyro) in [(250.0, 3), (500.0, 2), (1000.0, 1), (2000.0, 0)] {
            for (g, accel) in [(2.0, 3), (4.0, 2), (8.0, 1), (16.0, 0)] {
                let mut params = Params::default();
                params.set("imu_rate", rate).unwrap();
                params.set("imu_gyro_range", dps).unwrap();
                params.set("imu_accel_range", g).unwrap();
                run(async move {
                    let (mut driver, part) = pair(Config::from_params(&params));
                    driver.init().await.unwrap();
                    {
                        let part = part.borrow();
                        let b0 = part.banks[0];
                        assert_eq!((b0[0x4F], b0[0x50]), (gyro << 5 | odr, accel << 5 | odr));
                        assert_eq!(part.violations, Vec::<String>::new());
                    }
                    assert!((driver.rate_hz() - rate).abs() < 0.1);
                    {
                        let mut part = part.borrow_mut();
                        part.gyro = [0.5 * dps, 20.0, 30.0];
                        part.accel = [0.5 * g, 0.0, 1.0];
                    }
                    let _ = read(&mut driver).await;
                    let start = Instant::now();
                    let mut last = ImuReading::default();
                    for _ in 0..100 {
                        last = read(&mut driver).await.unwrap().unwrap();
                    }
                    let took = (Instant::now() - start).as_micros() as f32;
                    assert!((took * rate * 1e-8 - 1.0).abs() < 0.02, "{took} us at {rate} Hz");
                    // Two counts of noise at most.
                    let (gyro_error, accel_error) = (3.0 * dps / 32768.0, 3.0 * g * GRAVITY / 32768.0);
                    assert!(
                        (last.gyro.x.to_degrees() - 0.5 * dps).abs() < gyro_error,
                        "{last:?}"
                    );
                    assert!((last.accel.x - 0.5 * g * GRAVITY).abs() < accel_error, "{last:?}");
                });
            }
        }
    }
}

#[test]
fn the_part_is_looked_at_ten_times_a_second_at_every_rate() {
    for rate in [1000.0, 2000.0, 4000.0, 8000.0] {
        let mut params = Params::default();
        params.set("imu_rate", rate).unwrap();
        run(async move {
            let (mut driver, part) = pair(Config::from_params(&params));
            driver.init().await.unwrap();
            part.borrow_mut().transactions.clear();
            read_for(&mut driver, Duration::from_secs(1)).await;
            // A check reads six registers in 7 bytes.
            let looks = part.borrow().transactions.iter().filter(|&&n| n == 7).count();
            assert!((9..=10).contains(&looks), "{looks} at {rate} Hz");
        });
    }
}

#[test]
fn what_is_wrong_is_named_for_as_long_as_it_lasts() {
    let cases: [(Spoil, PortError); 4] = [
        (|p| p.failure = Failure::Ones, PortError::Absent),
        (|p| p.failure = Failure::Zeros, PortError::Absent),
        (|p| p.failure = Failure::Bus, PortError::Corrupt),
        (
            |p| {
                p.kind = Kind::Icm20689;
                p.reset();
            },
            PortError::WrongPart,
        ),
    ];
    for (spoil, error) in cases {
        for at_start in [true, false] {
            run(async move {
                let case = format!("{error:?}, at the start: {at_start}");
                let (mut driver, part) = pair(Config::default());
                if !at_start {
                    let (good, errors, _) = read_for(&mut driver, Duration::from_secs(1)).await;
                    assert!(good > 3600 && errors.is_empty(), "{case}: {good} {errors:?}");
                }
                spoil(&mut part.borrow_mut());
                let (_, errors, _) = read_for(&mut driver, Duration::from_millis(300)).await;
                assert!(
                    errors.len() >= 3 && errors.ends_with(&[error; 3]),
                    "{case}: {errors:?}"
                );
                let (good, errors, _) = read_for(&mut driver, Duration::from_secs(5)).await;
                assert!(
                    good == 0 && errors.iter().all(|&e| e == error),
                    "{case}: {good} {errors:?}"
                );
                {
                    let mut part = part.borrow_mut();
                    (part.failure, part.kind) = (Failure::None, Kind::Icm42688p);
                    part.reset();
                }
                let (good, ..) = read_for(&mut driver, Duration::from_millis(300)).await;
                assert!(good > 0, "{case}");
                let (_, errors, _) = read_for(&mut driver, Duration::from_millis(200)).await;
                assert!(errors.is_empty(), "{case}: {errors:?}");
            });
        }
    }
}
