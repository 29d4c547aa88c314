//! Executors of the levels; each task runs on its declared level.

use embassy_executor::{SendSpawner, SpawnToken, Spawner};
use sophie_tasks::schedule::{Level, TaskId};

pub struct Levels {
    flight: SendSpawner,
    steady: SendSpawner,
    background: Spawner,
}

impl Levels {
    pub fn new(background: Spawner) -> Self {
        let (flight, steady) = sophie_boards::start_levels();
        Self {
            flight,
            steady,
            background,
        }
    }

    /// Spawns `task` on its declared level.
    pub fn spawn<S: Send>(&self, task: TaskId, token: SpawnToken<S>) {
        let token = named(task.level(), task.name(), token);
        match task.level() {
            Level::Flight => self.flight.spawn(token),
            Level::Steady => self.steady.spawn(token),
            Level::Background => self.background.spawn(token),
        }
    }

    /// Spawns a task without a deadline in the background.
    pub fn spawn_unmeasured<S>(&self, name: &'static str, token: SpawnToken<S>) {
        self.background.spawn(named(Level::Background, name, token));
    }
}

/// Records a task's name and level; only for the trace.
#[cfg(not(feature = "trace"))]
fn named<T>(_: Level, _: &'static str, token: T) -> T {
    token
}

#[cfg(feature = "trace")]
use super::trace::named;
