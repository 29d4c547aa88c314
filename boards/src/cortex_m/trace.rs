//! Trace of the executors' events into a ring in RAM (feature `trace`).
//!
//! An event is two words: the clock's low half (µs), and from the lowest bit the kind (3 bits), the address of task or
//! executor without its two lowest bits (18 bits: enough within one memory) and the active exception (9 bits, 0 in
//! thread mode). [`drain`] empties the ring; events that do not fit are counted. Nothing is logged here: a log line
//! takes longer than most events.

use core::sync::atomic::Ordering::Relaxed;
use core::sync::atomic::{AtomicBool, AtomicU32};

use cortex_m::peripheral::SCB;
use embassy_time::Instant;

/// Capacity, a power of two: 20 ms of a flight, beyond any stall of the background.
pub const EVENTS: u32 = 1024;
/// Address bits of an event, and their shift.
const ADDRESS: u32 = 0x000F_FFFC;
const ADDRESS_SHIFT: u32 = 1;
const EXCEPTION_SHIFT: u32 = 21;

#[repr(u32)]
enum Kind {
    /// A task was woken.
    Ready = 0,
    /// A poll begins.
    Begin = 1,
    /// A poll ends.
    End = 2,
    /// An executor has nothing left to poll.
    Idle = 3,
}

static RING: [[AtomicU32; 2]; EVENTS as usize] =
    [const { [const { AtomicU32::new(0) }; 2] }; EVENTS as usize];
static WRITTEN: AtomicU32 = AtomicU32::new(0);
static READ: AtomicU32 = AtomicU32::new(0);
static LOST: AtomicU32 = AtomicU32::new(0);
/// Set once the clock runs: it must not be read before.
static ON: AtomicBool = AtomicBool::new(false);

/// Starts recording. The clock must run.
pub fn start() {
    ON.store(true, Relaxed);
}

fn record(kind: Kind, address: u32) {
    if !ON.load(Relaxed) {
        return;
    }
    let what = kind as u32 | (address & ADDRESS) << ADDRESS_SHIFT | exception() << EXCEPTION_SHIFT;
    critical_section::with(|_| {
        let written = WRITTEN.load(Relaxed);
        if written.wrapping_sub(READ.load(Relaxed)) >= EVENTS {
            LOST.store(LOST.load(Relaxed).wrapping_add(1), Relaxed);
        } else if let Some([time, event]) = RING.get((written % EVENTS) as usize) {
            time.store(Instant::now().as_ticks() as u32, Relaxed);
            event.store(what, Relaxed);
            WRITTEN.store(written.wrapping_add(1), Relaxed);
        }
    });
}

/// Active exception; 0 in thread mode.
fn exception() -> u32 {
    // SAFETY: the register exists on every Cortex-M; reading has no side effect.
    unsafe { (*SCB::PTR).icsr.read() & 0x1FF }
}

/// Moves events into `events`, oldest first; returns their number. Called by one task only.
pub fn drain(events: &mut [[u32; 2]]) -> usize {
    let mut count = 0;
    for slot in events {
        let read = READ.load(Relaxed);
        // Complete up to `WRITTEN`, set last in a critical section.
        if read == WRITTEN.load(Relaxed) {
            break;
        }
        if let Some(entry) = RING.get((read % EVENTS) as usize) {
            *slot = entry.each_ref().map(|word| word.load(Relaxed));
        }
        READ.store(read.wrapping_add(1), Relaxed);
        count += 1;
    }
    count
}

/// Events lost since the start.
pub fn lost() -> u32 {
    LOST.load(Relaxed)
}

/// The thread mode executor polled since it was idle: interrupts mostly wake it without work.
static POLLED: AtomicBool = AtomicBool::new(false);

// SAFETY (all seven): symbols declared by embassy-executor, each defined once with its signature.

#[unsafe(no_mangle)]
fn _embassy_trace_poll_start(_executor: u32) {}

#[unsafe(no_mangle)]
fn _embassy_trace_task_new(_executor: u32, _task: u32) {}

#[unsafe(no_mangle)]
fn _embassy_trace_task_end(_executor: u32, _task: u32) {}

#[unsafe(no_mangle)]
fn _embassy_trace_task_exec_begin(_executor: u32, task: u32) {
    if exception() == 0 {
        POLLED.store(true, Relaxed);
    }
    record(Kind::Begin, task);
}

#[unsafe(no_mangle)]
fn _embassy_trace_task_exec_end(_executor: u32, task: u32) {
    record(Kind::End, task);
}

#[unsafe(no_mangle)]
fn _embassy_trace_task_ready_begin(_executor: u32, task: u32) {
    record(Kind::Ready, task);
}

#[unsafe(no_mangle)]
fn _embassy_trace_executor_idle(executor: u32) {
    if exception() != 0 || POLLED.swap(false, Relaxed) {
        record(Kind::Idle, executor);
    }
}
