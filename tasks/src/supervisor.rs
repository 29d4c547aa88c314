//! The supervisor: the watchdog is fed only while everything runs that flying needs, and what must outlive its bite
//! is kept.
//!
//! 100 Hz, steady level, so that a flight level that never yields starves it too. A window of 100 ms in which
//! a task has made less than half of its runs, or a flight level that has gone stale after calibration, leaves
//! the watchdog unfed: with a period of 200 to 500 ms it then resets the board, which starts
//! disarmed, with the grip as it was.
//!
//! Not watched: rc (a lost radio is the failsafe's business, no fault of the board), arms (its bus may stall;
//! the mixer lives without) and telemetry.

use embassy_time::{Duration, Instant};

use crate::deadline::{FixedRate, Level, TaskId};
use crate::links::Links;
use crate::ports::{Retain, Watchdog};
use crate::retained_store::RetainedStore;

/// Time between two looks.
pub const PERIOD: Duration = Duration::from_millis(10);
/// Looks in a window.
const WINDOW: u8 = 10;
/// Time from power-up during which drivers may still be starting.
pub const BOOT_TIME: Duration = Duration::from_secs(3);

/// A watched task and the least number of its runs in a window: half of what its rate gives.
struct Watched {
    task: TaskId,
    least: u32,
}

/// Those of the flight level only count once the sensors are calibrated.
const WATCHED: [Watched; 9] = [
    Watched {
        task: TaskId::Imu,
        least: 50,
    },
    Watched {
        task: TaskId::Estimator,
        least: 50,
    },
    Watched {
        task: TaskId::Control,
        least: 50,
    },
    Watched {
        task: TaskId::Mixer,
        least: 50,
    },
    Watched {
        task: TaskId::Motors,
        least: 50,
    },
    Watched {
        task: TaskId::Analog,
        least: 25,
    },
    Watched {
        task: TaskId::Clamp,
        least: 5,
    },
    Watched {
        task: TaskId::Servos,
        least: 2,
    },
    Watched {
        task: TaskId::Commander,
        least: 5,
    },
];

/// Watches every task at 100 Hz; never returns.
pub async fn run(links: &Links, mut watchdog: impl Watchdog, memory: impl Retain) -> ! {
    let mut store = RetainedStore::new(links, memory);
    let mut health = Health::new(links, Instant::now());
    let mut rate = FixedRate::new(links, TaskId::Supervisor, PERIOD, PERIOD);
    loop {
        let tick = rate.next().await;
        store.keep(links);
        if health.look(links, tick.started) {
            watchdog.feed();
        }
    }
}

/// What the supervisor knows.
struct Health {
    power_up: Instant,
    looks: u8,
    runs: [u32; WATCHED.len()],
    alive: bool,
    calibrated: bool,
}

impl Health {
    fn new(links: &Links, now: Instant) -> Self {
        Self {
            power_up: now,
            looks: 0,
            runs: runs(links),
            alive: true,
            calibrated: false,
        }
    }

    /// One look; true while the watchdog may be fed.
    fn look(&mut self, links: &Links, now: Instant) -> bool {
        // Once calibrated always calibrated: a flight level that falls silent must not excuse itself.
        let newly = !self.calibrated && links.attitude.fresh().is_some_and(|a| a.calibrated);
        if newly {
            self.calibrated = true;
            self.looks = 0;
            self.runs = runs(links);
        }
        self.looks += 1;
        if self.looks >= WINDOW {
            self.looks = 0;
            let before = core::mem::replace(&mut self.runs, runs(links));
            self.alive = WATCHED
                .iter()
                .zip(self.runs.iter().zip(before))
                .all(|(w, (&now, before))| {
                    now.wrapping_sub(before) >= w.least
                        || (w.task.level() == Level::Flight && !self.calibrated)
                });
        }
        let fresh = links.attitude.fresh().is_some() && links.mix.fresh().is_some();
        let booting = now.saturating_duration_since(self.power_up) < BOOT_TIME;
        booting || (self.alive && (fresh || !self.calibrated))
    }
}

fn runs(links: &Links) -> [u32; WATCHED.len()] {
    WATCHED.each_ref().map(|w| links.timing(w.task).runs)
}
