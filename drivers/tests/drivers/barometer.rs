//! Both barometers' drivers on fake chips.

use std::cell::RefCell;
use std::rc::Rc;

use super::fake::{dps310, ms5611, run};
use embassy_time::{Duration, Instant, Timer};
use sophie_control::navigation::air_pressure::AirPressure;
use sophie_drivers::barometer::{Barometer, Chip};
use sophie_drivers::dps310::{Coefficients, Dps310};
use sophie_drivers::fault::Fault;
use sophie_drivers::ms5611::Ms5611;
use sophie_ports::error::PortError;
use sophie_ports::sensors::Barometer as _;

/// Calibration as of a real part: c0 205, c1 -264, c00 78,716, c10 -54,086, c01 -2,848, c11 1,387, c20 -10,156, c21 46,
/// c30 -1,385.
const COEFFICIENTS: [u8; 18] = [
    0x0C, 0xDE, 0xF8, 0x13, 0x37, 0xCF, 0x2C, 0xBA, 0xF4, 0xE0, 0x05, 0x6B, 0xD8, 0x54, 0x00, 0x2E, 0xFA,
    0x97,
];

/// Pressure and temperature of raw counts by the datasheet's formula (§4.9), in doubles.
fn by_the_datasheet(pressure: i32, temperature: i32) -> (f64, f64) {
    let (p, t) = (
        f64::from(pressure) / 7_864_320.0,
        f64::from(temperature) / 3_670_016.0,
    );
    let pascal = 78_716.0 + p * (-54_086.0 + p * (-10_156.0 + p * -1_385.0)) + t * -2_848.0;
    (pascal + t * p * (1_387.0 + p * 46.0), 205.0 * 0.5 + -264.0 * t)
}

fn bytes(count: i32) -> [u8; 3] {
    let [_, high, middle, low] = count.to_be_bytes();
    [high, middle, low]
}

#[test]
fn a_dps310_s_counts_become_what_the_datasheet_s_formula_says() {
    let coefficients = Coefficients::of(COEFFICIENTS);
    for pressure in [-3_300_000, -1_500_000, 0, 900_000, -8_388_608, 8_388_607] {
        for temperature in [-200_000, 0, 1_100_000, 2_000_000] {
            let (pascal, celsius) = coefficients.convert(bytes(pressure), bytes(temperature));
            let (p, t) = by_the_datasheet(pressure, temperature);
            let (off, warm) = (f64::from(pascal) - p, f64::from(celsius) - t);
            // A float of 100,000 has steps of 8 mPa.
            assert!(
                off.abs() < 0.05 && warm.abs() < 1e-4,
                "{pressure} {temperature}: {off} {warm}"
            );
        }
    }
}

/// Calls as the task does, 25 a second, for `time`; every result.
async fn calls<C: Chip>(barometer: &mut Barometer<C>, time: Duration) -> Vec<Result<AirPressure, PortError>> {
    let end = Instant::now() + time;
    let mut all = Vec::new();
    while Instant::now() < end {
        let begin = Instant::now();
        all.push(barometer.read().await);
        let took = (Instant::now() - begin).as_micros();
        assert!(took < 36_000, "{took} us");
        Timer::at(begin + Duration::from_millis(40)).await;
    }
    all
}

fn dps310() -> (Dps310<dps310::Bus>, Rc<RefCell<dps310::Chip>>) {
    let chip = dps310::Chip::new(COEFFICIENTS);
    // 94,600 Pa or so at 27 °C.
    chip.borrow_mut().pressure = -2_600_000;
    chip.borrow_mut().temperature = 1_049_000;
    (Dps310::at(dps310::Bus(chip.clone())), chip)
}

const SECOND: Duration = Duration::from_secs(1);

#[test]
fn a_dps310_is_corrected_set_up_and_read() {
    run(async {
        let (mut barometer, chip) = dps310();
        let all = calls(&mut barometer, SECOND).await;
        let (pascal, celsius) = by_the_datasheet(-2_600_000, 1_049_000);
        let sound: Vec<_> = all.iter().flatten().collect();
        assert!(sound.len() >= 20, "{} of {}", sound.len(), all.len());
        for air in &sound {
            let off = f64::from(air.pascal) - pascal;
            assert!(
                off.abs() < 0.1 && (f64::from(air.celsius) - celsius).abs() < 0.01,
                "{air:?}"
            );
        }
        let chip = chip.borrow();
        assert!(chip.corrected, "the fuse of some parts");
        // 8 samples of pressure, 4 of temperature by the sensor for which the coefficients are, nothing shifted.
        assert_eq!(chip.registers[0x06..0x0A], [0x03, 0x82, 0x00, 0x00]);
        assert_eq!(barometer.last_fault(), None);
    });
}

#[test]
fn a_dps310_that_does_not_acknowledge_its_reset_is_read() {
    run(async {
        let (mut barometer, chip) = dps310();
        chip.borrow_mut().failure = dps310::Failure::RefusesReset;
        let all = calls(&mut barometer, SECOND).await;
        assert!(all.last().unwrap().is_ok(), "{:?}", barometer.last_fault());
    });
}

#[test]
fn a_pressure_carries_the_time_of_its_middle() {
    run(async {
        let (mut barometer, _chip) = dps310();
        let _ = calls(&mut barometer, SECOND).await;
        // Its third measurement has no temperature before it.
        let _ = barometer.read().await;
        let begin = Instant::now().as_micros();
        let air = barometer.read().await.unwrap();
        let lag = Instant::now().as_micros() - air.at_us;
        assert!((7_300..12_000).contains(&lag) && air.at_us > begin, "{lag}");
    });
}

#[test]
fn a_board_without_a_dps310_asks_for_it_once_a_second() {
    run(async {
        let (mut barometer, chip) = dps310();
        chip.borrow_mut().failure = dps310::Failure::Missing;
        let all = calls(&mut barometer, Duration::from_secs(20)).await;
        assert!(all.iter().all(|air| *air == Err(PortError::Absent)));
        let asked = chip.borrow().transactions;
        assert!(asked <= 26, "{asked}");
        assert_eq!(
            (chip.borrow().writes.len(), barometer.last_fault()),
            (0, Some(Fault::Bus))
        );
        chip.borrow_mut().failure = dps310::Failure::None;
        let all = calls(&mut barometer, SECOND * 2).await;
        assert!(all.last().unwrap().is_ok());
    });
}

#[test]
fn another_chip_at_its_address_is_not_written_to() {
    run(async {
        let (mut barometer, chip) = dps310();
        // A BMP280.
        chip.borrow_mut().registers[0x0D] = 0x58;
        let all = calls(&mut barometer, SECOND * 3).await;
        assert!(all.iter().all(Result::is_err));
        let fault = Fault::Identity {
            expected: 0x10,
            found: 0x58,
        };
        assert_eq!(
            (chip.borrow().writes.len(), barometer.last_fault()),
            (0, Some(fault))
        );
    });
}

#[test]
fn a_dps310_that_fails_is_noticed_and_comes_back() {
    for (failure, fault) in [
        (dps310::Failure::Missing, Fault::Bus),
        (dps310::Failure::Stretched, Fault::Bus),
        (dps310::Failure::Mute, Fault::Silent),
    ] {
        run(async move {
            let (mut barometer, chip) = dps310();
            assert!(calls(&mut barometer, SECOND).await.last().unwrap().is_ok());
            chip.borrow_mut().failure = failure;
            let all = calls(&mut barometer, SECOND * 4).await;
            assert!(all.iter().all(Result::is_err), "{failure:?}");
            assert_eq!(barometer.last_fault(), Some(fault), "{failure:?}");
            let asked = chip.borrow().transactions;
            chip.borrow_mut().failure = dps310::Failure::None;
            let all = calls(&mut barometer, SECOND * 3).await;
            assert!(all.last().unwrap().is_ok(), "{failure:?} after {asked}");
        });
    }
}

#[test]
fn a_dps310_that_keeps_no_settings_gives_nothing() {
    run(async {
        let (mut barometer, chip) = dps310();
        chip.borrow_mut().failure = dps310::Failure::Deaf;
        let all = calls(&mut barometer, SECOND).await;
        assert!(all.iter().all(Result::is_err));
        assert!(matches!(
            barometer.last_fault(),
            Some(Fault::Configuration { .. })
        ));
    });
}

#[test]
fn a_value_that_stands_still_or_is_out_of_range_is_none() {
    run(async {
        let (mut barometer, chip) = dps310();
        chip.borrow_mut().noise = 0;
        let all = calls(&mut barometer, SECOND * 2).await;
        assert!(all.iter().any(Result::is_ok) && barometer.last_fault() == Some(Fault::Stuck));
        // 133 and 1,253 hPa.
        for pressure in [7_800_000, -8_388_000] {
            let (mut barometer, chip) = dps310();
            chip.borrow_mut().pressure = pressure;
            let (pascal, _) = by_the_datasheet(pressure, 1_049_000);
            assert!(!(30_000.0..=120_000.0).contains(&pascal), "{pascal}");
            let all = calls(&mut barometer, SECOND).await;
            assert!(all.iter().all(Result::is_err), "{pascal}");
            assert_eq!(barometer.last_fault(), Some(Fault::Garbled));
        }
        drop(chip);
    });
}

/// The datasheet's example: its coefficients and counts give 2,007 and 100,009. Word 7 ends with the checksum.
const PROM: [u16; 8] = [0x2A15, 40_127, 36_924, 23_317, 23_282, 33_464, 28_312, CHECKSUM];
const CHECKSUM: u16 = 0x1;
const COUNTS: [u32; 2] = [9_085_466, 8_569_150];

#[test]
fn an_ms5611_s_counts_become_what_the_datasheet_s_example_says() {
    run(async {
        let chip = ms5611::Chip::new(PROM, COUNTS);
        chip.borrow_mut().noise = 0;
        let mut barometer = Ms5611::on(ms5611::Bus(chip));
        let all = calls(&mut barometer, SECOND / 2).await;
        let air = all
            .last()
            .unwrap()
            .unwrap_or_else(|_| panic!("{:?}", barometer.last_fault()));
        assert!(
            (air.pascal - 100_009.0).abs() < 0.1 && (air.celsius - 20.07).abs() < 1e-3,
            "{air:?}"
        );
    });
}

#[test]
fn an_ms5611_that_is_missing_or_garbled_gives_nothing_and_comes_back() {
    for (failure, fault) in [
        (ms5611::Failure::Only(0x00), Fault::Garbled),
        (ms5611::Failure::Only(0xFF), Fault::Garbled),
        (ms5611::Failure::Bus, Fault::Bus),
    ] {
        run(async move {
            let chip = ms5611::Chip::new(PROM, COUNTS);
            let mut barometer = Ms5611::on(ms5611::Bus(chip.clone()));
            chip.borrow_mut().failure = failure;
            let all = calls(&mut barometer, SECOND * 10).await;
            assert!(all.iter().all(Result::is_err), "{failure:?}");
            assert_eq!(barometer.last_fault(), Some(fault), "{failure:?}");
            chip.borrow_mut().failure = ms5611::Failure::None;
            let all = calls(&mut barometer, SECOND * 2).await;
            assert!(all.last().unwrap().is_ok(), "{failure:?}");
            // While it runs.
            chip.borrow_mut().failure = failure;
            let all = calls(&mut barometer, SECOND * 2).await;
            assert!(all.iter().all(Result::is_err), "{failure:?}");
        });
    }
}

#[test]
fn an_ms5611_with_a_wrong_checksum_or_a_value_that_stands_still_is_none() {
    run(async {
        let mut prom = PROM;
        prom[1] ^= 0x0100;
        let mut barometer = Ms5611::on(ms5611::Bus(ms5611::Chip::new(prom, COUNTS)));
        let all = calls(&mut barometer, SECOND).await;
        assert!(all.iter().all(Result::is_err) && barometer.last_fault() == Some(Fault::Garbled));
        let chip = ms5611::Chip::new(PROM, COUNTS);
        chip.borrow_mut().noise = 0;
        let mut barometer = Ms5611::on(ms5611::Bus(chip));
        let all = calls(&mut barometer, SECOND * 2).await;
        assert!(all.iter().any(Result::is_ok) && barometer.last_fault() == Some(Fault::Stuck));
    });
}
