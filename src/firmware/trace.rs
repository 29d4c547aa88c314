//! The executor trace over defmt (feature `trace`): the tasks' names in rotation, and every event.
//!
//! ```text
//! trace task 240051c0 flight imu
//! trace 81920: [e8, 03, ...]
//! trace lost 12
//! ```
//!
//! The number before the events is the index of the first one since the start, which reveals events that the probe
//! dropped; each event has eight bytes ([`sophie_boards::trace`]), low byte first.

use core::cell::RefCell;

use embassy_executor::SpawnToken;
use embassy_sync::blocking_mutex::Mutex;
use embassy_time::{Duration, Ticker};
use heapless::Vec;
use sophie_tasks::links::last_value::Raw;
use sophie_tasks::schedule::Level;

use sophie_boards::trace;

const PERIOD: Duration = Duration::from_millis(2);
/// Polls between two names, so that any second of the log has all of them.
const NAME_EVERY: u32 = 20;
/// Events per line: encoding a longer one would delay interrupts.
const EVENTS: usize = 6;
const TASKS: usize = 20;

#[derive(Clone, Copy)]
struct Named {
    id: u32,
    level: Level,
    name: &'static str,
}

static TASKS_SPAWNED: Mutex<Raw, RefCell<Vec<Named, TASKS>>> = Mutex::new(RefCell::new(Vec::new()));

/// Records the name and level of `token`'s task.
pub fn named<S>(level: Level, name: &'static str, token: SpawnToken<S>) -> SpawnToken<S> {
    trace::start();
    let id = token.id();
    // A task that does not fit is shown by its number.
    TASKS_SPAWNED.lock(|tasks| {
        let _ = tasks.borrow_mut().push(Named { id, level, name });
    });
    token
}

/// Background, spawned last: logs the events; never returns.
#[embassy_executor::task]
pub async fn trace() -> ! {
    let mut ticker = Ticker::every(PERIOD);
    let (mut looks, mut sent, mut lost) = (0u32, 0u32, 0);
    loop {
        ticker.next().await;
        if looks.is_multiple_of(NAME_EVERY) {
            name(looks / NAME_EVERY);
        }
        looks = looks.wrapping_add(1);
        // At most the ring's contents: later events wait for the next poll.
        for _ in 0..=trace::EVENTS as usize / EVENTS {
            let mut events = [[0; 2]; EVENTS];
            let count = trace::drain(&mut events);
            let mut bytes = [0; 8 * EVENTS];
            for (slot, word) in bytes.as_chunks_mut().0.iter_mut().zip(events.as_flattened()) {
                *slot = word.to_le_bytes();
            }
            if count == 0 {
                break;
            }
            let payload = bytes.get(..8 * count).unwrap_or_default();
            defmt::info!("trace {=u32}: {=[u8]:02x}", sent, payload);
            sent = sent.wrapping_add(count as u32);
        }
        let now = trace::lost();
        if now != lost {
            lost = now;
            defmt::warn!("trace lost {=u32}", now);
        }
    }
}

fn name(turn: u32) {
    let task = TASKS_SPAWNED.lock(|tasks| {
        let tasks = tasks.borrow();
        let count = tasks.len().max(1);
        tasks.get(turn as usize % count).copied()
    });
    if let Some(Named { id, level, name }) = task {
        defmt::info!("trace task {=u32:08x} {=str} {=str}", id, level.name(), name);
    }
}
