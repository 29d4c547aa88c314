//! The watchdog is fed only while every task needed for flight runs.

use embassy_time::{Duration, Instant};
use sophie_control::chain::{Attitude, MixOutput};
use sophie_tasks::links::Links;
use sophie_tasks::schedule::TaskId;
use sophie_tasks::schedule::timing::Run;
use sophie_tasks::supervision::supervisor;

use crate::rig::Rig;
use sophie_fakes::{FakeMemory, FakeWatchdog};

/// Watched tasks and their least runs in 100 ms, half of nominal.
const WATCHED: [(TaskId, u32); 9] = [
    (TaskId::Imu, 50),
    (TaskId::Estimator, 50),
    (TaskId::Control, 50),
    (TaskId::Mixer, 50),
    (TaskId::Motors, 50),
    (TaskId::Analog, 25),
    (TaskId::Clamp, 5),
    (TaskId::Servos, 2),
    (TaskId::Commander, 5),
];

fn ran(links: &Links, task: TaskId, at: Instant) {
    let run = Run {
        released: at,
        started: at,
        ended: at,
        deadline: Duration::from_millis(1),
        skipped: 0,
    };
    links.timing.record(task, &run);
}

struct Bench {
    rig: Rig,
    watchdog: FakeWatchdog,
    ms: u64,
    calibrated: bool,
    attitude: bool,
    mix: bool,
}

impl Bench {
    fn new() -> Self {
        let (rig, watchdog) = (Rig::new(), FakeWatchdog::default());
        let memory = FakeMemory::default();
        rig.time
            .spawn(supervisor::run(rig.links, watchdog.clone(), memory));
        Self {
            rig,
            watchdog,
            ms: 0,
            calibrated: true,
            attitude: true,
            mix: true,
        }
    }

    /// Runs for `ms`, a multiple of 100, with the least runs of every task but `other` (runs per 100 ms); returns the
    /// feeds of the last 100 ms.
    fn run(&mut self, ms: u64, other: Option<(TaskId, u32)>) -> usize {
        let (calibrated, attitude, mix) = (self.calibrated, self.attitude, self.mix);
        let mut burst = self.ms;
        self.rig.run_with(ms, |links, at| {
            if burst % 100 == 55 {
                for (task, least) in WATCHED {
                    let (_, runs) = other.filter(|(t, _)| *t == task).unwrap_or((task, least));
                    (0..runs).for_each(|_| ran(links, task, at));
                }
            }
            burst += 1;
            if attitude {
                let estimate = Attitude {
                    calibrated,
                    ..Attitude::default()
                };
                links.attitude.send(at, estimate);
            }
            if mix {
                links.mix.send(at, MixOutput::default());
            }
        });
        self.ms += ms;
        self.watchdog.fed_since((self.ms - 100) * 1000 + 1)
    }
}

#[test]
fn half_of_every_rate_is_enough_and_one_run_less_of_any_task_is_not() {
    for (task, least) in WATCHED {
        let mut bench = Bench::new();
        assert_eq!(bench.run(4000, None), 10, "{task:?}");
        for runs in [least - 1, 0] {
            bench.run(200, Some((task, runs)));
            assert_eq!(bench.run(300, Some((task, runs))), 0, "{task:?}, {runs} runs");
            bench.run(200, None);
            assert_eq!(bench.run(300, None), 10, "{task:?} runs again");
        }
    }
}

#[test]
fn before_calibration_the_flight_level_may_be_silent_and_the_others_may_not() {
    for (place, (task, _)) in WATCHED.into_iter().enumerate() {
        let mut bench = Bench::new();
        bench.calibrated = false;
        let fed = bench.run(4000, Some((task, 0)));
        assert_eq!(fed, if place < 5 { 10 } else { 0 }, "{task:?}");
        bench.calibrated = true;
        bench.run(200, Some((task, 0)));
        assert_eq!(bench.run(200, Some((task, 0))), 0, "{task:?}");
        // Once calibrated, no excuse.
        bench.calibrated = false;
        assert_eq!(bench.run(200, Some((task, 0))), 0, "{task:?}");
    }
}

#[test]
fn for_three_seconds_after_power_up_it_is_fed_whatever_happens() {
    let mut bench = Bench::new();
    let nothing = Some((TaskId::Clamp, 0));
    for _ in 0..30 {
        assert_eq!(bench.run(100, nothing), 10);
    }
    assert_eq!(bench.run(100, nothing), 0);
}

#[test]
fn a_stale_attitude_or_mix_leaves_it_unfed_at_once() {
    for lost in [|b: &mut Bench| b.attitude = false, |b: &mut Bench| b.mix = false] {
        let mut bench = Bench::new();
        assert_eq!(bench.run(4000, None), 10);
        lost(&mut bench);
        // Stale after 5 and 10 ms: one or two checks may still be in time.
        assert!(bench.run(100, None) <= 2);
        assert_eq!(bench.run(100, None), 0);
    }
}
