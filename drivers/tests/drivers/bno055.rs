//! The arm sensors' driver on fake chips.

use std::cell::RefCell;
use std::rc::Rc;

use super::fake::i2c::{Bus, Chip, Failure, OnReset};
use super::fake::run;
use embassy_time::{Duration, Instant, Timer};
use sophie_control::maths::vector::Vec3;
use sophie_drivers::arm_buses::ArmBuses;
use sophie_drivers::bno055::{Config, Fusion};
use sophie_drivers::fault::Fault;
use sophie_drivers::mounting::{Heading, Mounting};
use sophie_ports::error::PortError;
use sophie_ports::sensors::ArmImus;

type Chips = [Rc<RefCell<Chip>>; 4];

fn arms(configs: [Config; 4]) -> (ArmBuses<Bus, Bus>, Chips) {
    let chips = [0x28, 0x29, 0x28, 0x29].map(Chip::new);
    let [one, two, three, four] = chips.clone();
    (
        ArmBuses::new(Bus(vec![one, two]), Bus(vec![three, four]), configs),
        chips,
    )
}

struct Call {
    result: Result<Vec3, PortError>,
    took: Duration,
}

async fn round(arms: &mut ArmBuses<Bus, Bus>) -> [Call; 4] {
    let mut calls = Vec::new();
    for arm in 0..4 {
        let start = Instant::now();
        let result = arms.gravity(arm).await;
        calls.push(Call {
            result,
            took: Instant::now() - start,
        });
    }
    calls.try_into().ok().unwrap()
}

async fn rounds(arms: &mut ArmBuses<Bus, Bus>, time: Duration) -> [Call; 4] {
    let end = Instant::now() + time;
    loop {
        let calls = round(arms).await;
        Timer::after_millis(10).await;
        if Instant::now() >= end {
            return calls;
        }
    }
}

#[test]
fn four_chips_come_up_in_a_second_and_a_half_without_a_long_call() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        let start = Instant::now();
        let mut worst = Duration::from_ticks(0);
        loop {
            let calls = round(&mut arms).await;
            worst = worst.max(calls.iter().map(|c| c.took).max().unwrap());
            if calls.iter().all(|c| c.result.is_ok()) {
                break;
            }
            Timer::after_millis(10).await;
        }
        let took = (Instant::now() - start).as_millis();
        // 650 ms of boot after power-on and reset.
        assert!(took < 2200, "{took} ms");
        assert!(worst < Duration::from_millis(3), "{} µs", worst.as_micros());
        for chip in &chips {
            let chip = chip.borrow();
            assert_eq!(chip.violations, Vec::<String>::new());
            assert!(chip.writes.contains(&(0, 0x3F, 0x20)), "reset");
            assert_eq!(chip.writes.last(), Some(&(0, 0x3D, 0x08)), "mode last");
            let p0 = chip.pages[0];
            assert_eq!((p0[0x3B], p0[0x3E], p0[0x41], p0[0x42]), (0x80, 0x00, 0x24, 0x00));
        }
        let calibration = arms.calibration(3).unwrap();
        assert_eq!((calibration.gyro, calibration.accel), (3, 0));
    });
}

#[test]
fn a_chip_found_in_the_middle_of_its_fusion_is_started_afresh() {
    run(async {
        let (mut arms, chips) = arms(
            [Config {
                fusion: Fusion::Ndof,
                ..Config::default()
            }; 4],
        );
        Timer::after_millis(700).await;
        // As a reset of the processor alone leaves it.
        chips[0].borrow_mut().pages[0][0x3D] = 0x0C;
        let calls = rounds(&mut arms, Duration::from_secs(2)).await;
        assert!(calls.iter().all(|c| c.result.is_ok()));
        assert_eq!(chips[0].borrow().pages[0][0x3D], 0x0C);
    });
}

/// The chip resets where it should acknowledge: Adafruit's `adafruit_bno055.py` takes an error of this write for success.
#[test]
fn a_reset_that_is_not_acknowledged_or_holds_the_clock_is_a_reset() {
    let held = |ms| OnReset::Held(Duration::from_millis(ms));
    for running in [false, true] {
        for on_reset in [
            OnReset::Acknowledged,
            OnReset::Refused,
            held(2),
            held(40),
            held(400),
        ] {
            run(async move {
                let (mut arms, chips) = arms([Config::default(); 4]);
                Timer::after_millis(700).await;
                for chip in &chips {
                    chip.borrow_mut().on_reset = on_reset;
                    if running {
                        // As a restart of the processor alone leaves it.
                        chip.borrow_mut().pages[0][0x3D] = 0x08;
                    }
                }
                let calls = rounds(&mut arms, Duration::from_secs(3)).await;
                let what = format!("{on_reset:?}, running {running}");
                assert!(
                    calls.iter().all(|c| c.result.is_ok()),
                    "{what}: {:?}",
                    arms.last_fault(0)
                );
                for chip in &chips {
                    let chip = chip.borrow();
                    assert_eq!(chip.violations, Vec::<String>::new(), "{what}");
                    // A neighbour that holds the clock lets no reset through, which a sound chip does without.
                    let least = u32::from(!matches!(on_reset, OnReset::Held(_)));
                    assert!((least..=1).contains(&chip.resets), "{what}: {}", chip.resets);
                }
            });
        }
    }
}

/// An STM32L4 at 400 kHz sees 180 µs after each byte; 26 registers take up to 6 ms elsewhere.
#[test]
fn a_chip_that_stretches_each_byte_is_read() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        chips.iter().for_each(|chip| chip.borrow_mut().stretch = 180);
        let calls = rounds(&mut arms, Duration::from_secs(3)).await;
        assert!(calls.iter().all(|c| c.result.is_ok()), "{:?}", arms.last_fault(0));
    });
}

#[test]
fn a_chip_left_on_its_second_page_is_found() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        Timer::after_millis(700).await;
        // A processor-only reset leaves chips in any mode.
        chips[0].borrow_mut().pages[0][0x07] = 1;
        chips[1].borrow_mut().pages[0][0x07] = 1;
        chips[1].borrow_mut().pages[0][0x3D] = 0x08;
        let calls = rounds(&mut arms, Duration::from_secs(2)).await;
        assert!(calls.iter().all(|c| c.result.is_ok()), "{:?}", arms.last_fault(0));
        assert!((0..4).all(|arm| arms.last_fault(arm).is_none()));
        // A glitch changes the page in readings, boot, or configuration mode.
        for wait in [0, 725, 735] {
            chips[2].borrow_mut().pages[0][0x07] = 1;
            rounds(&mut arms, Duration::from_millis(wait)).await;
            chips[2].borrow_mut().pages[0][0x07] = 1;
            let calls = rounds(&mut arms, Duration::from_secs(3)).await;
            assert!(calls.iter().all(|c| c.result.is_ok()), "{wait} ms");
        }
        assert!(chips.iter().all(|chip| chip.borrow().violations.is_empty()));
    });
}

#[test]
fn a_chip_that_is_no_bno055_is_not_written_to() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        chips[0].borrow_mut().pages[0][0x00] = 0x55;
        let _ = rounds(&mut arms, Duration::from_secs(3)).await;
        assert_eq!(chips[0].borrow().writes, []);
    });
}

#[test]
fn gravity_points_down_in_the_arm_s_axes() {
    run(async {
        let down = |heading| Config {
            mounting: Mounting::top_down(heading),
            ..Config::default()
        };
        let up = |heading| Config {
            mounting: Mounting::top_up(heading),
            ..Config::default()
        };
        let configs = [
            up(Heading::Forward),
            up(Heading::Left),
            down(Heading::Forward),
            down(Heading::Right),
        ];
        let (mut arms, chips) = arms(configs);
        rounds(&mut arms, Duration::from_secs(2)).await;
        // Level: +z out of the chip's marking.
        chips[0].borrow_mut().gravity = [0, 0, 981];
        chips[1].borrow_mut().gravity = [0, 0, 981];
        chips[2].borrow_mut().gravity = [0, 0, -981];
        chips[3].borrow_mut().gravity = [0, 0, -981];
        for call in round(&mut arms).await {
            let g = call.result.unwrap();
            assert!((g - Vec3::new(0.0, 0.0, 9.81)).norm() < 1e-3, "{g:?}");
        }
        // Right side down by 30°: gravity leans to body +y, specific force to body -y.
        let (side, height) = (490, 850);
        chips[0].borrow_mut().gravity = [0, side, height]; // y is left
        chips[1].borrow_mut().gravity = [side, 0, height]; // x is left
        chips[2].borrow_mut().gravity = [0, -side, -height]; // y is right
        chips[3].borrow_mut().gravity = [-side, 0, -height]; // x is right
        for call in round(&mut arms).await {
            let g = call.result.unwrap();
            assert!((g - Vec3::new(0.0, 4.9, 8.5)).norm() < 1e-3, "{g:?}");
        }
    });
}

#[test]
fn a_missing_chip_is_absent_and_asked_ever_less() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        chips[1].borrow_mut().failure = Failure::Missing;
        rounds(&mut arms, Duration::from_secs(10)).await;
        chips[1].borrow_mut().transactions = 0;
        let calls = rounds(&mut arms, Duration::from_secs(10)).await;
        assert_eq!(calls[1].result, Err(PortError::Absent));
        assert_eq!(arms.last_fault(1), Some(Fault::Bus));
        assert_eq!(arms.calibration(1), None);
        assert!([0, 2, 3].iter().all(|&i| calls[i].result.is_ok()));
        let asked = chips[1].borrow().transactions;
        assert!((5..=12).contains(&asked), "{asked}");
        chips[1].borrow_mut().failure = Failure::None;
        let calls = rounds(&mut arms, Duration::from_secs(3)).await;
        assert!(calls[1].result.is_ok());
    });
}

#[test]
fn a_held_clock_costs_6_ms_at_most_and_not_every_round() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        rounds(&mut arms, Duration::from_secs(2)).await;
        chips[2].borrow_mut().failure = Failure::Stretched;
        let mut late = 0;
        for i in 0..200 {
            let calls = round(&mut arms).await;
            assert!(
                calls[2].took <= Duration::from_micros(6100),
                "{} µs",
                calls[2].took.as_micros()
            );
            assert!(matches!(
                calls[2].result,
                Err(PortError::Timeout | PortError::Absent)
            ));
            assert!([0, 1, 3].iter().all(|&i| calls[i].result.is_ok()), "round {i}");
            late += u32::from(calls[2].took > Duration::from_millis(1));
            Timer::after_millis(10).await;
        }
        // Three readings, then attempts after 20, 40, 80 ... ms.
        assert!(late <= 10, "{late} slow rounds of 200");
        chips[2].borrow_mut().failure = Failure::None;
        let calls = rounds(&mut arms, Duration::from_secs(4)).await;
        assert!(calls[2].result.is_ok());
    });
}

#[test]
fn a_chip_that_resets_itself_is_noticed_at_once_and_set_up_again() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        rounds(&mut arms, Duration::from_secs(2)).await;
        // Back from a brown-out.
        chips[3].borrow_mut().pages[0][0x3D] = 0x00;
        let calls = round(&mut arms).await;
        assert_eq!(calls[3].result, Err(PortError::Corrupt));
        let fault = Fault::Configuration {
            bank: 0,
            register: 0x3D,
            expected: 0x08,
            found: 0x00,
        };
        assert_eq!(arms.last_fault(3), Some(fault));
        let calls = rounds(&mut arms, Duration::from_secs(2)).await;
        assert!(calls[3].result.is_ok());
        chips[3].borrow_mut().reset();
        let calls = rounds(&mut arms, Duration::from_millis(40)).await;
        assert_eq!(calls[3].result, Err(PortError::Absent));
        let calls = rounds(&mut arms, Duration::from_secs(4)).await;
        assert!(calls[3].result.is_ok());
    });
}

#[test]
fn nonsense_is_refused() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        rounds(&mut arms, Duration::from_secs(2)).await;
        chips[0].borrow_mut().failure = Failure::Reads(0xFF);
        chips[1].borrow_mut().failure = Failure::Reads(0x00);
        chips[2].borrow_mut().gravity = [0, 0, 300];
        chips[3].borrow_mut().calibration = 0x0F;
        let calls = round(&mut arms).await;
        let results: Vec<_> = calls.iter().map(|c| c.result).collect();
        let corrupt = Err(PortError::Corrupt);
        assert_eq!(results, [corrupt, corrupt, corrupt, Err(PortError::Absent)]);
        chips[0].borrow_mut().failure = Failure::None;
        chips[1].borrow_mut().failure = Failure::None;
        chips[2].borrow_mut().gravity = [0, 0, 981];
        chips[3].borrow_mut().calibration = 0x10;
        let calls = round(&mut arms).await;
        assert!(calls.iter().all(|c| c.result.is_ok()));
    });
}

#[test]
fn a_wrong_chip_is_named() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        chips[0].borrow_mut().pages[0][0x00] = 0x55;
        let calls = rounds(&mut arms, Duration::from_secs(1)).await;
        assert_eq!(calls[0].result, Err(PortError::Absent));
        assert_eq!(
            arms.last_fault(0),
            Some(Fault::Identity {
                expected: 0xA0,
                found: 0x55
            })
        );
    });
}

#[test]
fn a_fusion_that_does_not_start_leads_to_a_reset() {
    run(async {
        let (mut arms, chips) = arms([Config::default(); 4]);
        chips[0].borrow_mut().status = 4;
        chips[1].borrow_mut().status = 1;
        rounds(&mut arms, Duration::from_secs(6)).await;
        for (arm, chip) in chips.iter().take(2).enumerate() {
            let resets = chip
                .borrow()
                .writes
                .iter()
                .filter(|&&w| w == (0, 0x3F, 0x20))
                .count();
            assert!(resets >= 2, "arm {arm}: {resets}");
            assert_eq!(arms.last_fault(arm), Some(Fault::Silent));
            chip.borrow_mut().status = 5;
        }
        let calls = rounds(&mut arms, Duration::from_secs(5)).await;
        assert!(calls.iter().all(|c| c.result.is_ok()));
    });
}

#[test]
fn an_arm_that_does_not_exist_is_absent() {
    run(async {
        let (mut arms, _) = arms([Config::default(); 4]);
        assert_eq!(arms.gravity(4).await, Err(PortError::Absent));
    });
}

#[test]
fn a_slow_chip_is_waited_for_and_a_broken_one_fails_alone() {
    // Power-up of the chips.
    for late_ms in [0, 100, 300, 600] {
        run(async move {
            let (mut arms, chips) = arms([Config::default(); 4]);
            rounds(&mut arms, Duration::from_millis(late_ms)).await;
            chips.iter().for_each(|chip| chip.borrow_mut().reset());
            let sound = |calls: &[Call; 4]| calls.each_ref().map(|call| call.result.is_ok());
            let calls = rounds(&mut arms, Duration::from_millis(2500 - late_ms)).await;
            assert_eq!(sound(&calls), [true; 4], "{late_ms} ms late");
            for _ in 0..300 {
                assert_eq!(sound(&round(&mut arms).await), [true; 4], "{late_ms} ms late");
                Timer::after_millis(10).await;
            }
            chips[1].borrow_mut().failure = Failure::Missing;
            for _ in 0..100 {
                assert_eq!(sound(&round(&mut arms).await), [true, false, true, true]);
                Timer::after_millis(10).await;
            }
            chips[2].borrow_mut().failure = Failure::Stretched;
            chips[3].borrow_mut().failure = Failure::Stretched;
            for _ in 0..100 {
                assert_eq!(sound(&round(&mut arms).await), [true, false, false, false]);
                Timer::after_millis(10).await;
            }
            for chip in &chips {
                chip.borrow_mut().failure = Failure::None;
            }
            let calls = rounds(&mut arms, Duration::from_secs(3)).await;
            assert_eq!(sound(&calls), [true; 4]);
        });
    }
}
