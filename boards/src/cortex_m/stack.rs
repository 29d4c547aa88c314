//! Greatest stack depth, from the start-up's paint. All levels share the stack: background + steady + flight + a
//! driver's interrupt.

/// Paint of cortex-m-rt (feature `paint-stack`).
const PAINT: u32 = 0xCCCC_CCCC;

/// Stack size, and bytes never used.
pub fn size_and_free() -> (usize, usize) {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let size = start as usize - end as usize;
    let mut free = 0;
    while free < size {
        // SAFETY: within the stack, aligned; volatile, since interrupts below this frame may write there.
        let word = unsafe { end.byte_add(free).read_volatile() };
        if word != PAINT {
            break;
        }
        free += 4;
    }
    (size, free)
}
