//! Reads possibly damaged flash of the H7, which has error correction per 32 bytes.
//!
//! Power loss during a write leaves an uncorrectable word. Reading it is a bus fault, which would end every start; here
//! it is an error (RM0433 §4.3.12, §4.7.7).

use core::arch::asm;

use embassy_stm32::pac;

/// Core configuration and control register (ARMv7-M, B3.2.8).
const CCR: *mut u32 = 0xE000_ED14 as *mut u32;
/// Data bus faults are ignored at hard fault priority.
const BFHFNMIGN: u32 = 1 << 8;

/// Parameter bank: the second.
fn bank() -> pac::flash::Bank {
    pac::FLASH.bank(1)
}

/// Clears old errors. embassy-stm32 0.6 clears them in a register that is not writable here, so they would recur at
/// each access.
pub fn forget_errors() {
    bank().ccr().write(|w| {
        w.set_clr_wrperr(true);
        w.set_clr_pgserr(true);
        w.set_clr_strberr(true);
        w.set_clr_incerr(true);
        w.set_clr_operr(true);
        w.set_clr_rdperr(true);
        w.set_clr_rdserr(true);
        w.set_clr_sneccerr(true);
        w.set_clr_dbeccerr(true);
    });
}

/// Suppresses data bus faults.
///
/// Never inlined: `cargo xtask` finds the guard in an image by its name.
///
/// # Safety
/// FAULTMASK raises the following code to hard fault priority: no interrupt runs until [`end_guard`].
#[inline(never)]
unsafe fn begin_guard() {
    // SAFETY: the core's own register; the bit has no effect below hard fault priority.
    unsafe {
        asm!("cpsid f");
        CCR.write_volatile(CCR.read_volatile() | BFHFNMIGN);
        asm!("dsb", "isb");
    }
}

/// Undoes [`begin_guard`].
///
/// # Safety
/// Only after it.
unsafe fn end_guard() {
    // SAFETY: as above.
    unsafe {
        asm!("dsb", "isb");
        CCR.write_volatile(CCR.read_volatile() & !BFHFNMIGN);
        asm!("dsb", "isb");
        asm!("cpsie f");
    }
}

/// Calls `read`; `None` if it met an uncorrectable word. All interrupts wait: some microseconds for a few bytes.
pub fn read<T>(read: impl FnOnce() -> T) -> Option<T> {
    forget_errors();
    // SAFETY: both are undone before anything else runs. `read` only copies bytes.
    let result = unsafe {
        begin_guard();
        let result = read();
        end_guard();
        result
    };
    let damaged = bank().sr().read().dbeccerr();
    forget_errors();
    (!damaged).then_some(result)
}
