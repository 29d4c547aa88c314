//! Greatest stack depth, measured by the pattern that start-up paints. All levels share the stack: background + steady
//! + flight + a driver's interrupt.

use core::arch::asm;
use core::sync::atomic::{AtomicU32, Ordering};

use sophie_ports::stack_use::StackUse;

/// Paint of cortex-m-rt (feature `paint-stack`).
const PAINT: u32 = 0xCCCC_CCCC;

/// Greatest depth while the board started, bytes; 0 until that has ended.
static START: AtomicU32 = AtomicU32::new(0);

/// First address of the stack, and its end.
fn bounds() -> (*const u32, *const u32) {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    (&raw const _stack_end, &raw const _stack_start)
}

/// How deep the stack has been. Reads every unused word, for less than a millisecond: for the background.
pub fn stack_use() -> StackUse {
    let (first, end) = bounds();
    let bytes = end as u32 - first as u32;
    let mut free = 0;
    while free < bytes {
        // SAFETY: within the stack, aligned; volatile, since interrupts below this frame may write there.
        let word = unsafe { first.byte_add(free as usize).read_volatile() };
        if word != PAINT {
            break;
        }
        free += 4;
    }
    let flight = bytes - free;
    let start = match START.load(Ordering::Relaxed) {
        0 => flight,
        noted => noted,
    };
    StackUse { bytes, start, flight }
}

/// Notes the depth so far as that of the start-up, and paints the unused part again. Once, in thread mode.
pub fn start_has_ended() {
    START.store(stack_use().flight, Ordering::Relaxed);
    let (first, _) = bounds();
    // SAFETY: writes from the stack's first address to the stack pointer, below which thread mode keeps no data; an
    // interrupt between two stores has already left its frame. No frame of this function lies below the pointer
    // meanwhile.
    unsafe {
        asm!(
            "2:",
            "cmp {at}, sp",
            "bhs 3f",
            "str {paint}, [{at}], #4",
            "b 2b",
            "3:",
            at = inout(reg) first => _,
            paint = in(reg) PAINT,
            options(nostack),
        );
    }
}
