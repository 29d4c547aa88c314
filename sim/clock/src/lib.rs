//! Virtual time: embassy clock and executor of one flight, confined to its thread.
//!
//! The clock stands still while tasks run and jumps to the next alarm when all wait. It is thread-local behind the
//! process-wide embassy-time driver: parallel flights are independent.

use std::cell::{Cell, RefCell};
use std::future::Future;
use std::task::Waker;

use embassy_executor::raw::{self, TaskStorage};
use embassy_time_queue_utils::Queue;

thread_local! {
    static NOW: Cell<u64> = const { Cell::new(0) };
    static NEXT: Cell<u64> = const { Cell::new(u64::MAX) };
    static QUEUE: RefCell<Queue> = const { RefCell::new(Queue::new()) };
    static PENDED: Cell<bool> = const { Cell::new(false) };
}

struct ThreadClock;
embassy_time_driver::time_driver_impl!(static CLOCK: ThreadClock = ThreadClock);

impl embassy_time_driver::Driver for ThreadClock {
    fn now(&self) -> u64 {
        NOW.get()
    }

    fn schedule_wake(&self, at: u64, waker: &Waker) {
        QUEUE.with_borrow_mut(|queue| {
            if queue.schedule_wake(at, waker) {
                NEXT.set(queue.next_expiration(NOW.get()));
            }
        });
    }
}

#[allow(unsafe_code, reason = "the executor asks its platform for this symbol")]
// SAFETY: the symbol is defined once, with the signature that embassy-executor documents.
#[unsafe(export_name = "__pender")]
fn pender(_context: *mut ()) {
    PENDED.set(true);
}

struct OneThread;
critical_section::set_impl!(OneThread);

#[allow(unsafe_code, reason = "a critical section is an unsafe promise by nature")]
// SAFETY: everything a flight shares stays in one thread (clock, executor and links are created there and are not
// `Send` together with their tasks), so nothing can run between acquire and release.
unsafe impl critical_section::Impl for OneThread {
    unsafe fn acquire() {}
    unsafe fn release(_state: ()) {}
}

/// Clock and executor of a flight; one per thread at a time.
pub struct VirtualTime {
    executor: &'static raw::Executor,
}

impl VirtualTime {
    /// Clears the thread's state of an earlier flight.
    #[must_use]
    #[allow(
        clippy::new_without_default,
        reason = "it resets the thread's clock: not a default of anything"
    )]
    pub fn new() -> Self {
        NOW.set(0);
        NEXT.set(u64::MAX);
        QUEUE.set(Queue::new());
        PENDED.set(false);
        // Leaked: wakers may point to it for the life of the process.
        Self {
            executor: Box::leak(Box::new(raw::Executor::new(core::ptr::null_mut()))),
        }
    }

    /// Spawns a task.
    pub fn spawn<F: Future + 'static>(&self, future: F) {
        let storage: &'static TaskStorage<F> = Box::leak(Box::new(TaskStorage::new()));
        if let Ok(token) = storage.spawn(move || future) {
            self.executor.spawner().spawn(token);
        }
    }

    /// Runs the tasks from alarm to alarm until `until_us`.
    pub fn run_until(&self, until_us: u64) {
        self.settle();
        loop {
            let now = NEXT.get().min(until_us).max(NOW.get());
            NOW.set(now);
            QUEUE.with_borrow_mut(|queue| NEXT.set(queue.next_expiration(now)));
            self.settle();
            // Alarms due now come before the clock advances.
            if now >= until_us && NEXT.get() > until_us {
                break;
            }
        }
    }

    fn settle(&self) {
        while PENDED.replace(false) {
            #[allow(unsafe_code, reason = "raw::Executor::poll is unsafe")]
            // SAFETY: the executor is polled from this thread alone and never from within a task.
            unsafe {
                self.executor.poll();
            }
        }
    }
}
