//! Fixed rates under the virtual clock: no bursts, every miss counted, dt bounded.

use std::cell::RefCell;
use std::rc::Rc;

use embassy_time::{Duration, Instant, Timer};
use sophie_clock::VirtualTime;
use sophie_control::params::Params;
use sophie_tasks::deadline::{FixedRate, Tick, begins_next};
use sophie_tasks::links::Links;
use sophie_tasks::schedule::TaskId;

const PERIOD: Duration = Duration::from_millis(1);
const DEADLINE: Duration = Duration::from_micros(400);

/// Runs a 1 kHz loop for `ms`, run n taking `work(n)` µs.
fn run(ms: u64, work: impl Fn(usize) -> u64 + 'static) -> (Vec<Tick>, &'static Links) {
    let time = VirtualTime::new();
    let links: &'static Links = Box::leak(Box::new(Links::new(Params::default())));
    let ticks = Rc::new(RefCell::new(Vec::new()));
    let seen = ticks.clone();
    time.spawn(async move {
        let mut rate = FixedRate::new(links, TaskId::Analog, PERIOD, DEADLINE);
        for n in 0.. {
            let tick = rate.next().await;
            seen.borrow_mut().push(tick);
            Timer::after_micros(work(n)).await;
        }
    });
    time.run_until(ms * 1000);
    let ticks = ticks.borrow().clone();
    (ticks, links)
}

#[test]
fn an_idle_loop_keeps_its_rate_exactly() {
    let (ticks, links) = run(1000, |_| 100);
    assert_eq!(ticks.len(), 1001);
    assert!(
        ticks
            .iter()
            .enumerate()
            .all(|(i, t)| t.started == Instant::from_millis(i as u64))
    );
    assert!(ticks.iter().all(|t| (t.dt - 1e-3).abs() < 1e-9));
    let timing = links.timing.task(TaskId::Analog);
    assert_eq!(
        (
            timing.overruns,
            timing.worst_response_us,
            timing.worst_lateness_us
        ),
        (0, 100, 0)
    );
}

#[test]
fn a_stall_is_counted_and_never_made_up_for_by_a_burst() {
    // Run 10 takes 4.5 ms: releases at 11, 12, 13 and 14 ms pass unserved.
    let (ticks, links) = run(100, |n| if n == 10 { 4500 } else { 50 });
    let starts: Vec<u64> = ticks.iter().map(|t| t.started.as_micros()).collect();
    assert!(starts.windows(2).all(|w| w[1] - w[0] >= 500), "burst: {starts:?}");
    // ActiveTerminal late at 14.5 ms, then in phase again.
    assert_eq!(&starts[10..13], &[10_000, 14_500, 15_000]);
    let timing = links.timing.task(TaskId::Analog);
    // The long run, three skipped releases, and the late run.
    assert_eq!(timing.overruns, 1 + 3 + 1);
    assert_eq!(timing.worst_response_us, 4500);
    assert!(ticks.iter().all(|t| (0.5e-3..=4e-3).contains(&t.dt)));
}

#[test]
fn a_run_that_ends_after_its_deadline_is_an_overrun() {
    let (_, links) = run(100, |n| if n % 10 == 0 { 500 } else { 50 });
    assert_eq!(links.timing.task(TaskId::Analog).overruns, 10);
}

#[test]
fn a_loop_that_is_always_too_slow_settles_at_a_divided_rate() {
    let (ticks, links) = run(100, |_| 1500);
    assert!((60..=70).contains(&ticks.len()), "{}", ticks.len());
    assert!(links.timing.task(TaskId::Analog).overruns as usize >= ticks.len() - 1);
}

#[test]
fn periods_begin_at_the_tasks_phase_whenever_it_is_spawned() {
    for spawned in [0, 1, 599, 600, 601, 9_999, 123_456] {
        let time = VirtualTime::new();
        let links: &'static Links = Box::leak(Box::new(Links::new(Params::default())));
        let seen = Rc::new(RefCell::new(Vec::new()));
        for task in [TaskId::Servos, TaskId::Clamp, TaskId::Analog] {
            let seen = seen.clone();
            time.spawn(async move {
                Timer::after_micros(spawned).await;
                let mut rate = FixedRate::of(links, task);
                loop {
                    let tick = rate.next().await;
                    assert_eq!(tick.started, tick.released);
                    seen.borrow_mut().push((tick.started.as_micros(), task));
                }
            });
        }
        time.run_until(spawned + 100_000);
        let seen = seen.borrow();
        for &(started, task) in seen.iter() {
            assert_eq!(
                started % task.period().as_micros(),
                task.phase().as_micros(),
                "{task:?}"
            );
        }
        // A conversion, its step, its pulses within 1 ms.
        let in_order = seen.windows(3).filter(|three| {
            let [(converted, a), (_, b), (written, c)] = three else {
                return false;
            };
            [*a, *b, *c] == [TaskId::Analog, TaskId::Clamp, TaskId::Servos] && written - converted < 1000
        });
        let count = in_order.count();
        assert!((4..=6).contains(&count), "spawned at {spawned} us: {seen:?}");
    }
}

#[test]
fn a_phase_beyond_the_period_wraps() {
    let [period, phase] = [Duration::from_micros(3003), Duration::from_micros(3103)];
    for (now, next) in [(0, 100), (100, 100), (101, 3103), (3103, 3103), (6005, 6106)] {
        let next = Instant::from_micros(next);
        assert_eq!(begins_next(Instant::from_micros(now), period, phase), next);
    }
}
