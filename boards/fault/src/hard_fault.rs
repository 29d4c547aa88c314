//! Hard fault handler: unmapped addresses, undefined instructions, stack overflow.
//!
//! It does not use the old stack: after an overflow that would fault again, locking the processor up without a message
//! and with the motors unchanged.

use core::arch::naked_asm;

use crate::end_of_run;

/// Bytes of an exception frame without floats.
const FRAME: u32 = 32;
/// Fault status: stacking failed by memory protection or by the bus (ARMv7-M, B3.2.15).
const STACKING: u32 = 1 << 4 | 1 << 12;

/// Validity of the addresses of memory and bus faults.
const MEMORY_ADDRESS: u32 = 1 << 7;
const BUS_ADDRESS: u32 = 1 << 15;

/// Entry in the vector table: reads the frame if it lies in the stack, then restarts the stack from its top.
///
/// # Safety
/// Only the processor calls it.
#[unsafe(no_mangle)]
#[unsafe(naked)]
#[allow(non_snake_case, reason = "the name that the vector table wants")]
unsafe extern "C" fn HardFault() -> ! {
    naked_asm!(
        // Cancels a pending save of floats to the old stack (FPCCR.LSPACT).
        "movw r3, #0xEF34",
        "movt r3, #0xE000",
        "ldr r2, [r3]",
        "bic r2, #1",
        "str r2, [r3]",
        "mrs r0, msp",
        "movs r1, #0",
        "movs r2, #0",
        "movw r3, #:lower16:_stack_end",
        "movt r3, #:upper16:_stack_end",
        "cmp r0, r3",
        "blo 2f",
        "movw r3, #:lower16:_stack_start",
        "movt r3, #:upper16:_stack_start",
        "subs r3, {frame}",
        "cmp r0, r3",
        "bhi 2f",
        "ldr r1, [r0, #24]",
        "ldr r2, [r0, #20]",
        "2:",
        "movw r3, #:lower16:_stack_start",
        "movt r3, #:upper16:_stack_start",
        "msr msp, r3",
        "b {record}",
        frame = const FRAME,
        record = sym record,
    )
}

/// Ends the run. `stacked`: address of the frame; `pc`, `lr`: from it, if readable.
extern "C" fn record(stacked: u32, pc: u32, lr: u32) -> ! {
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    let (end, start) = (&raw const _stack_end as u32, &raw const _stack_start as u32);
    // Configurable fault status, HardFault status, addresses of memory and bus faults (ARMv7-M, B3.2).
    let [cfsr, hfsr, mmfar, bfar] =
        [0xE000_ED28, 0xE000_ED2C, 0xE000_ED34, 0xE000_ED38_usize].map(|address| {
            // SAFETY: core registers, always present and readable without side effects.
            unsafe { (address as *const u32).read_volatile() }
        });
    if cfsr & STACKING != 0 || !(end..=start - FRAME).contains(&stacked) {
        end_of_run(format_args!(
            "stack overflow: it ends at {end:#010x} and has {} bytes",
            start - end
        ))
    }
    let address = match cfsr {
        _ if cfsr & BUS_ADDRESS != 0 => bfar,
        _ if cfsr & MEMORY_ADDRESS != 0 => mmfar,
        _ => 0,
    };
    end_of_run(format_args!(
        "hard fault at {pc:#010x}, called from {lr:#010x}: CFSR {cfsr:#010x} HFSR {hfsr:#010x} address {address:#010x}"
    ))
}
