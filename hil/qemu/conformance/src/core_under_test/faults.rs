//! Ends of runs: stack overflow, unmapped address, a fault during a fault's report. The flight handlers
//! (`sophie-fault`) continue with the next line instead of a restart.

use core::arch::{asm, global_asm};
use core::fmt::{self, Arguments, Write as _};
use core::hint::black_box;
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use cortex_m::asm::{dsb, isb};

use crate::traces::{Left, STOPPED, with_kept};

/// Guard below the stack: first address, log2 of its bytes. Replaces unmapped memory, which QEMU's machines ignore.
const NOWHERE: u32 = 0x1FFF_F000;
const NOWHERE_SIZE: u32 = 12;
/// On, also in fault handlers, only in defined regions (ARMv7-M, B3.5).
const PROTECTED: u32 = 0b111;
/// Stack bytes left to the handler.
const HANDLER: usize = 8192;
/// Words of an exception frame; index of return address and program status.
const FRAME: usize = 8;
const PC: usize = 6;
const STATUS: usize = 7;
const THUMB: u32 = 1 << 24;

#[unsafe(no_mangle)]
static CONFORMANCE_STACK: AtomicU32 = AtomicU32::new(0);

global_asm!(
    ".syntax unified",
    ".fpu fpv4-sp-d16",
    // Calls the function in r0; returns even if that ends the run.
    ".thumb_func",
    ".global conformance_try",
    "conformance_try:",
    "push {{r4-r11, lr}}",
    "sub sp, #4",
    "vpush {{s16-s31}}",
    "ldr r1, =CONFORMANCE_STACK",
    "str sp, [r1]",
    "blx r0",
    ".thumb_func",
    ".global conformance_go_on",
    "conformance_go_on:",
    "vpop {{s16-s31}}",
    "add sp, #4",
    "pop {{r4-r11, pc}}",
    ".ltorg",
);

unsafe extern "C" {
    fn conformance_try(scenario: extern "C" fn());
    fn conformance_go_on();
}

/// Continues in `conformance_try`, in thread mode, from any handler.
pub fn go_on() -> ! {
    sophie_fault::ENDING.store(false, Relaxed);
    let stack = CONFORMANCE_STACK.load(Relaxed) as *mut u32;
    // SAFETY: `conformance_try` left its registers above that, and its callee will not continue. In a handler the frame
    // makes the processor return there; thread mode jumps to the same place.
    unsafe {
        if cortex_m::peripheral::SCB::vect_active() == cortex_m::peripheral::scb::VectActive::ThreadMode {
            asm!(
                "cpsie i",
                "mov sp, {stack}",
                "bx {place}",
                stack = in(reg) stack,
                place = in(reg) conformance_go_on as *const () as u32,
                options(noreturn),
            );
        }
        let frame = stack.sub(FRAME);
        for word in 0..FRAME {
            frame.add(word).write_volatile(0);
        }
        frame
            .add(PC)
            .write_volatile(conformance_go_on as *const () as u32 & !1);
        frame.add(STATUS).write_volatile(THUMB);
        asm!(
            "cpsie i",
            "msr msp, {frame}",
            "mvn lr, #6",
            "bx lr",
            frame = in(reg) frame,
            options(noreturn),
        );
    }
}

/// Prints a line per scenario, then calls `done`; cannot return: the handler overwrites the top of the stack.
pub fn run(print: &mut dyn FnMut(Arguments<'_>), done: fn() -> !) -> ! {
    let room = black_box([0u8; HANDLER]);
    try_all(print, done);
    // Keeps the room; never reached.
    black_box(&room);
    done()
}

#[inline(never)]
fn try_all(print: &mut dyn FnMut(Arguments<'_>), done: fn() -> !) {
    let scenarios: [(&str, extern "C" fn()); 4] = [
        ("a stack overflows", overflow),
        ("a stack overflows with floats", float_overflow),
        ("nothing there", nothing_there),
        ("a fault in a message", fault_in_a_message),
    ];
    // SAFETY: nothing uses that memory, and nothing else uses the memory protection.
    unsafe {
        let mpu = &*cortex_m::peripheral::MPU::PTR;
        mpu.rnr.write(0);
        mpu.rbar.write(NOWHERE);
        // No access.
        mpu.rasr.write(1 << 28 | (NOWHERE_SIZE - 1) << 1 | 1);
        mpu.ctrl.write(PROTECTED);
    }
    dsb();
    isb();
    for (name, scenario) in scenarios {
        STOPPED.store(false, Relaxed);
        // SAFETY: fault status registers; ones clear what former scenarios left.
        unsafe {
            (0xE000_ED28 as *mut u32).write_volatile(u32::MAX);
            (0xE000_ED2C as *mut u32).write_volatile(u32::MAX);
        }
        // SAFETY: it returns with every callee-saved register restored.
        unsafe { conformance_try(scenario) };
        let stopped = if STOPPED.load(Relaxed) {
            "stopped"
        } else {
            "running"
        };
        let mut left = Left::new();
        let _ = with_kept(|words| write!(left, "{words}"));
        print(format_args!("{name}: motors {stopped}, kept: {left}"));
    }
    done();
}

#[expect(unconditional_recursion, reason = "that is what is tried")]
fn deeper(words: &[u32; 16]) -> u32 {
    let more = words.map(|word| black_box(word).wrapping_add(1));
    deeper(black_box(&more)).wrapping_add(words[3])
}

extern "C" fn overflow() {
    black_box(deeper(&[0; 16]));
}

#[expect(unconditional_recursion, reason = "that is what is tried")]
fn deeper_with_floats(value: f32) -> f32 {
    let more = black_box(value) * 1.5 + 1.0;
    deeper_with_floats(black_box(more)) + black_box(more) * value
}

extern "C" fn float_overflow() {
    black_box(deeper_with_floats(1.0));
}

fn read_nowhere() -> u32 {
    // SAFETY: the read gives no value; the processor faults.
    unsafe { (NOWHERE as *const u32).read_volatile() }
}

extern "C" fn nothing_there() {
    black_box(read_nowhere());
}

struct Unreadable;

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", read_nowhere())
    }
}

extern "C" fn fault_in_a_message() {
    sophie_fault::end_of_run(format_args!("{Unreadable}"))
}
