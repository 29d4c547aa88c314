//! Virtual time: the embassy clock and executor of one flight, confined to the thread that flies it.
//!
//! The clock stands still while tasks run and jumps to the next alarm when none is left. It is thread-local
//! behind the process-wide embassy-time driver, so flights in parallel threads know nothing of each other.

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
// SAFETY: whatever a flight shares lives and dies in one thread (clock, executor and links are created there
// and are not `Send` together with their tasks), so nothing can run between acquire and release.
unsafe impl critical_section::Impl for OneThread {
    unsafe fn acquire() {}
    unsafe fn release(_state: ()) {}
}

/// The clock and executor of one flight. One at a time in a thread.
pub struct VirtualTime {
    executor: &'static raw::Executor,
}

impl VirtualTime {
    /// A clock at 0 and an executor without tasks; forgets what an earlier flight left in this thread.
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
        // Leaked on purpose: wakers of the flight may point to it for as long as the process lives.
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

    /// Runs the tasks, jumping from alarm to alarm, until the clock shows `until_us`.
    pub fn run_until(&self, until_us: u64) {
        self.settle();
        loop {
            let now = NEXT.get().min(until_us).max(NOW.get());
            NOW.set(now);
            QUEUE.with_borrow_mut(|queue| NEXT.set(queue.next_expiration(now)));
            self.settle();
            // An alarm set for this very moment is served before the clock moves on.
            if now >= until_us && NEXT.get() > until_us {
                break;
            }
        }
    }

    /// Polls until no task is ready.
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
