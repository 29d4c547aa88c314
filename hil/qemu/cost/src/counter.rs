//! Counts executed instructions.

use core::fmt::Arguments;
use core::sync::atomic::{Ordering, compiler_fence};

#[derive(Clone, Copy)]
pub struct Tally {
    pub calls: u32,
    pub total: u64,
    pub min: u32,
    pub max: u32,
}

impl Tally {
    pub const fn new() -> Self {
        Self {
            calls: 0,
            total: 0,
            min: u32::MAX,
            max: 0,
        }
    }

    pub fn add(&mut self, count: u32) {
        self.calls += 1;
        self.total += u64::from(count);
        self.min = self.min.min(count);
        self.max = self.max.max(count);
    }
}

/// Instructions of `work`, the call and reading the counter. Not inlined and called with several functions: all are
/// called alike.
#[inline(never)]
pub fn gross<S, I>(work: fn(&mut S, &I), state: &mut S, input: &I) -> u32 {
    let before = clock::now();
    // Keeps instructions from moving across.
    compiler_fence(Ordering::SeqCst);
    work(state, input);
    compiler_fence(Ordering::SeqCst);
    instructions(before.wrapping_sub(clock::now()))
}

/// 128 ns an instruction, 40 ns a tick.
const fn instructions(ticks: u32) -> u32 {
    (ticks * 5 + 8) / 16
}

pub use clock::{known, known_loop, start};

#[cfg(target_os = "none")]
#[allow(unsafe_code, reason = "the timer's registers, and a loop of known length")]
mod clock {
    use core::arch::asm;

    /// CMSDK timer 0 of QEMU's mps2 boards: 25 MHz, counting down.
    const TIMER: usize = 0x4000_0000;
    const CONTROL: *mut u32 = TIMER as *mut u32;
    const VALUE: *mut u32 = (TIMER + 4) as *mut u32;
    const RELOAD: *mut u32 = (TIMER + 8) as *mut u32;

    pub fn start() {
        // SAFETY: the timer's registers, which nothing else uses.
        unsafe {
            RELOAD.write_volatile(u32::MAX);
            VALUE.write_volatile(u32::MAX);
            CONTROL.write_volatile(1);
        }
    }

    #[inline(always)]
    pub fn now() -> u32 {
        // SAFETY: reading the timer has no side effect.
        unsafe { VALUE.read_volatile() }
    }

    /// Executes 2 `rounds` instructions (`rounds` > 0) and one to load it.
    #[inline(never)]
    pub fn known_loop(_: &mut (), rounds: &u32) {
        // SAFETY: counts its own register down to zero.
        unsafe {
            asm!("2:", "subs {n}, {n}, #1", "bne 2b", n = inout(reg) *rounds => _);
        }
    }

    pub const fn known(rounds: u32) -> u32 {
        2 * rounds + 1
    }
}

#[cfg(not(target_os = "none"))]
mod clock {
    /// The host counts nothing.
    pub fn start() {}

    pub fn now() -> u32 {
        0
    }

    pub fn known_loop(_: &mut (), _: &u32) {}

    pub const fn known(_: u32) -> u32 {
        0
    }
}

/// Prints the counts of a stage.
pub fn line(print: &mut dyn FnMut(Arguments<'_>), name: &str, t: &Tally) {
    print(format_args!(
        "stage {name} {} {} {} {}",
        t.calls, t.total, t.min, t.max
    ));
}
