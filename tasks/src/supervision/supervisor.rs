//! Supervisor: feeds the watchdog only while every task needed for flight runs, and keeps the retained state.
//!
//! It stops feeding after a window of 100 ms in which a task has made less than half of its runs, or with a stale
//! flight level after calibration; a flight level that never yields starves it. After 200 to 560 ms the watchdog then
//! resets the board, which starts disarmed with the grip as it was. [`crate::schedule`] declares the watched tasks.

use embassy_time::{Duration, Instant};

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::schedule::{Level, TaskId, Watch};
use crate::supervision::retained_store::RetainedStore;
use sophie_ports::chip::Watchdog;
use sophie_ports::retained::Retain;

const WINDOW: u8 = 10;
/// Time from power-up for drivers to start.
pub const BOOT_TIME: Duration = Duration::from_secs(3);

/// Least runs of a watched task in a window, half of its nominal; `None` if not watched. Tasks of the flight level
/// count only after calibration.
pub const fn least_runs(task: TaskId) -> Option<u32> {
    let window = TaskId::Supervisor.period().as_ticks() * WINDOW as u64;
    match task.task().watch {
        Watch::Watched => Some((window / task.period().as_ticks() / 2) as u32),
        Watch::Unwatched => None,
    }
}

/// Watches every task; never returns.
pub async fn run(links: &Links, mut watchdog: impl Watchdog, memory: impl Retain) -> ! {
    let mut store = RetainedStore::new(links, memory);
    let mut health = Health::new(links, Instant::now());
    let mut rate = FixedRate::of(links, TaskId::Supervisor);
    loop {
        let tick = rate.next().await;
        store.keep(links);
        if health.look(links, tick.started) {
            watchdog.feed();
        }
    }
}

struct Health {
    power_up: Instant,
    looks: u8,
    runs: [u32; TaskId::COUNT],
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

    /// One check; true if the watchdog may be fed.
    fn look(&mut self, links: &Links, now: Instant) -> bool {
        // Stays calibrated: a silent flight level must not excuse itself.
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
            let runs = self.runs.iter().zip(before);
            self.alive = TaskId::ALL.into_iter().zip(runs).all(|(task, (&now, before))| {
                least_runs(task).is_none_or(|least| now.wrapping_sub(before) >= least)
                    || (task.level() == Level::Flight && !self.calibrated)
            });
        }
        let fresh = links.attitude.fresh().is_some() && links.mix.fresh().is_some();
        let booting = now.saturating_duration_since(self.power_up) < BOOT_TIME;
        booting || (self.alive && (fresh || !self.calibrated))
    }
}

fn runs(links: &Links) -> [u32; TaskId::COUNT] {
    TaskId::ALL.map(|task| links.timing.task(task).runs)
}
