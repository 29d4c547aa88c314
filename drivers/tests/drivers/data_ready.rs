//! A data-ready line that is silent, returns, or is loose, on both parts.

use std::cell::RefCell;
use std::rc::Rc;

use super::fake::run;
use super::fake::spi::{Bus, DataReady, Failure, Kind, Part};
use embassy_time::{Duration, Instant, with_timeout};
use sophie_control::params::Params;
use sophie_drivers::fault::Fault;
use sophie_drivers::mounting::Mounting;
use sophie_drivers::spi_imu::{Chip, SpiImu};
use sophie_drivers::{icm20689, icm42688p};
use sophie_ports::error::PortError;
use sophie_ports::sensors::{IMU_SILENCE, Imu};

type Shared = Rc<RefCell<Part>>;

fn pair<C: Chip>(kind: Kind, chip: C) -> (SpiImu<C, Bus, DataReady>, Shared) {
    let part = Part::new(kind);
    let (bus, line) = (Bus(part.clone()), DataReady(part.clone()));
    (SpiImu::new(bus, line, chip, Mounting::default()), part)
}

fn at_rate(hz: f32) -> Params {
    let mut params = Params::default();
    params.set("imu_rate", hz).unwrap();
    params
}

#[derive(Debug, Default)]
struct Read {
    stamps: Vec<u64>,
    errors: Vec<PortError>,
    gap: u64,
}

async fn read_for(driver: &mut impl Imu, ms: u64) -> Read {
    let end = Instant::now() + Duration::from_millis(ms);
    let (mut read, mut last) = (Read::default(), Instant::now().as_micros());
    while Instant::now() < end {
        match with_timeout(IMU_SILENCE, driver.read()).await {
            Ok(Ok(_)) => {
                let now = Instant::now().as_micros();
                read.gap = read.gap.max(now - last);
                last = now;
                read.stamps.push(driver.ready_at().as_micros());
            }
            Ok(Err(error)) => read.errors.push(error),
            Err(_) => (),
        }
    }
    read
}

/// Cuts and joins the line of a part whose clock is off by `skew` µs per period.
async fn cut_and_joined<C: Chip>(mut driver: SpiImu<C, Bus, DataReady>, part: Shared, skew: i64) {
    driver.init().await.unwrap();
    part.borrow_mut().skew = skew;
    let rate = driver.rate_hz();
    let period = part.borrow().period().unwrap();
    let each = (1e6 / f64::from(rate)) as u64;
    let case = format!("{} at {rate} Hz, {skew} us off", C::NAME);
    read_for(&mut driver, 50).await;
    part.borrow_mut().failure = Failure::LineCut;
    let writes = part.borrow().writes.len();

    // 3 ms until the wait is dropped, a check, a new sample.
    let first = read_for(&mut driver, 190).await;
    assert!(first.errors.is_empty(), "{case}: {first:?}");
    assert!(first.gap < 3100 + each + each / 4, "{case}: {} us", first.gap);
    assert!(!driver.line_silent(), "{case}: too soon");
    part.borrow_mut().samples.clear();
    let start = Instant::now().as_micros();
    let timed = read_for(&mut driver, 1000).await;
    assert!(driver.line_silent(), "{case}");
    assert!(
        timed.errors.is_empty() && timed.gap < 2 * each,
        "{case}: {} us",
        timed.gap
    );
    // As many as the part makes, within 2 %, all different.
    let samples = part.borrow().samples.clone();
    let share = samples.len() as f64 / f64::from(rate);
    assert!((0.98..1.02).contains(&share), "{case}: {share}");
    assert!(samples.windows(2).all(|pair| pair[0] < pair[1]), "{case}: twice");
    // At most a quarter of a period and a transfer late.
    for (stamp, sample) in timed.stamps.iter().zip(&samples) {
        let late = stamp.cast_signed() - (sample * period).cast_signed();
        // With several samples per read: the newest.
        let most = if each > period { period } else { period / 4 }.cast_signed() + 10;
        assert!(
            *stamp >= start && (-25..=most).contains(&late),
            "{case}: {late} us late"
        );
    }
    assert_eq!(part.borrow().writes.len(), writes, "{case}: the part is well");

    part.borrow_mut().failure = Failure::None;
    let joined = Instant::now();
    while driver.line_silent() {
        assert!(
            with_timeout(IMU_SILENCE, driver.read()).await.unwrap().is_ok(),
            "{case}"
        );
    }
    let took = (Instant::now() - joined).as_millis();
    assert!((49..250).contains(&took), "{case}: {took} ms");
    part.borrow_mut().transactions.clear();
    let back = read_for(&mut driver, 90).await;
    assert!(
        back.errors.is_empty() && back.gap < 2 * each,
        "{case}: {} us",
        back.gap
    );
    let asked = part.borrow().transactions.iter().filter(|&&n| n == 2).count();
    // A check of the part reads its identity.
    assert!(asked <= 1, "{case}: {asked}");
    assert_eq!(part.borrow().violations, Vec::<String>::new(), "{case}");
}

#[test]
fn a_cut_line_is_done_without_and_used_again_once_it_is_joined() {
    for (rate, skew) in [
        (1000.0, 0),
        (1000.0, 9),
        (2000.0, -4),
        (4000.0, 2),
        (4000.0, 0),
        (4000.0, -2),
        (8000.0, 1),
    ] {
        run(async move {
            let (driver, part) = pair(Kind::Icm42688p, icm42688p::Config::from_params(&at_rate(rate)));
            cut_and_joined(driver, part, skew).await;
        });
    }
    // At 8 kHz every sample counts.
    for (rate, skew) in [(1000.0, 0), (4000.0, 1), (8000.0, -1)] {
        run(async move {
            let (driver, part) = pair(Kind::Icm20689, icm20689::Config::from_params(&at_rate(rate)));
            cut_and_joined(driver, part, skew).await;
        });
    }
}

#[test]
fn a_part_that_hangs_is_reset_whether_its_line_is_cut_or_not() {
    for line_cut_before in [false, true] {
        run(async move {
            let (mut driver, part) = pair(Kind::Icm42688p, icm42688p::Config::default());
            driver.init().await.unwrap();
            if line_cut_before {
                part.borrow_mut().failure = Failure::LineCut;
            }
            let read = read_for(&mut driver, 300).await;
            assert!(read.errors.is_empty() && driver.line_silent() == line_cut_before);
            let writes = part.borrow().writes.len();
            part.borrow_mut().failure = Failure::Mute;
            let hung = read_for(&mut driver, 30).await;
            assert!(
                hung.stamps.len() < 3,
                "{} samples of a part that has none",
                hung.stamps.len()
            );
            assert_eq!(driver.last_fault(), Some(Fault::Silent));
            assert_eq!(part.borrow().writes.get(writes), Some(&(0, 0x11, 0x01)), "reset");
            part.borrow_mut().failure = if line_cut_before {
                Failure::LineCut
            } else {
                Failure::None
            };
            read_for(&mut driver, 300).await;
            let read = read_for(&mut driver, 100).await;
            assert!(read.errors.is_empty() && read.stamps.len() > 390, "{read:?}");
            assert_eq!(driver.line_silent(), line_cut_before);
        });
    }
}

#[test]
fn a_line_that_the_part_was_told_to_leave_alone_is_configured_again() {
    for (kind, register, value) in [(Kind::Icm42688p, 0x65, 0x10), (Kind::Icm20689, 0x38, 0x00)] {
        run(async move {
            match kind {
                Kind::Icm42688p => forgets(pair(kind, icm42688p::Config::default()), register, value).await,
                Kind::Icm20689 => forgets(pair(kind, icm20689::Config::default()), register, value).await,
            }
        });
    }
}

async fn forgets<C: Chip>((mut driver, part): (SpiImu<C, Bus, DataReady>, Shared), register: u8, value: u8) {
    driver.init().await.unwrap();
    read_for(&mut driver, 20).await;
    part.borrow_mut().banks[0][usize::from(register)] = value;
    read_for(&mut driver, 300).await;
    assert!(
        matches!(driver.last_fault(), Some(Fault::Configuration { register: r, found, .. }) if (r, found) == (register, value & 0x7F)),
        "{:?}",
        driver.last_fault()
    );
    let read = read_for(&mut driver, 100).await;
    assert!(read.errors.is_empty() && read.stamps.len() > 390 && !driver.line_silent());
}

#[test]
fn a_loose_contact_is_reported_and_samples_come_throughout() {
    run(async {
        let (mut driver, part) = pair(Kind::Icm42688p, icm42688p::Config::default());
        driver.init().await.unwrap();
        part.borrow_mut().skew = 1;
        let mut reported = Vec::new();
        for nth in 0..8 {
            part.borrow_mut().failure = Failure::LineCut;
            let read = read_for(&mut driver, 5).await;
            part.borrow_mut().failure = Failure::None;
            assert!(read.errors.is_empty(), "{read:?}");
            let mut this_time = false;
            for _ in 0..10 {
                let read = read_for(&mut driver, 100).await;
                assert!(
                    read.errors.is_empty() && read.gap < 600 && read.stamps.len() > 380,
                    "{read:?}"
                );
                this_time |= driver.line_silent();
            }
            if this_time {
                reported.push(nth);
            }
        }
        // One or two silences are not reported; then agreement takes longer each time.
        assert!(
            matches!(reported[..], [1 | 2, ..]) && reported.len() >= 6,
            "{reported:?}"
        );
        read_for(&mut driver, 5000).await;
        assert!(!driver.line_silent());
    });
}

#[test]
fn a_cut_line_is_reported_after_a_fifth_of_a_second_and_taken_back() {
    run(async {
        let (mut driver, part) = pair(Kind::Icm42688p, icm42688p::Config::default());
        read_for(&mut driver, 1000).await;
        part.borrow_mut().failure = Failure::LineCut;
        let (start, mut reported) = (Instant::now(), None);
        let mut last = start;
        while Instant::now() < start + Duration::from_secs(2) {
            let read = with_timeout(IMU_SILENCE, driver.read()).await;
            if matches!(read, Ok(Ok(_))) {
                // What reads the port holds a sample for 5 ms.
                let gap = Instant::now() - last;
                assert!(gap < Duration::from_micros(4600), "{} us", gap.as_micros());
                last = Instant::now();
            }
            if reported.is_none() && driver.line_silent() {
                reported = Some((Instant::now() - start).as_millis());
            }
        }
        assert!(
            reported.is_some_and(|ms| (195..215).contains(&ms)),
            "{reported:?}"
        );
        part.borrow_mut().failure = Failure::None;
        read_for(&mut driver, 300).await;
        assert!(!driver.line_silent());
    });
}
