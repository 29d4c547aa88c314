//! Reading flash that may be damaged on the H7, whose every 32 bytes carry an error correction.
//!
//! Power that fails in the middle of a write leaves a word that cannot be corrected, and reading it is a bus fault: met
//! at the start, it would end every start. Here such a word is an error like any other (RM0433 §4.3.12, §4.7.7).

use core::arch::asm;

use embassy_stm32::pac;

/// Configuration and control register of the core (ARMv7-M, B3.2.8).
const CCR: *mut u32 = 0xE000_ED14 as *mut u32;
/// Handlers at the priority of a hard fault or above ignore bus faults of data.
const BFHFNMIGN: u32 = 1 << 8;

/// The bank of the parameters: the second.
fn bank() -> pac::flash::Bank {
    pac::FLASH.bank(1)
}

/// Clears what earlier accesses left. embassy-stm32 0.6 does it in a register that cannot be written here, and so takes
/// an old error for one of each later access.
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

/// Lets bus faults of data pass from here on.
///
/// A function of its own that is never inlined: by its name `cargo xtask` finds the guard in an image.
///
/// # Safety
/// FAULTMASK raises what follows to the priority of a hard fault: no interrupt runs until [`end_guard`] is called.
#[inline(never)]
unsafe fn begin_guard() {
    // SAFETY: the register is the core's own, and the bit changes nothing below the priority of a hard fault.
    unsafe {
        asm!("cpsid f");
        CCR.write_volatile(CCR.read_volatile() | BFHFNMIGN);
        asm!("dsb", "isb");
    }
}

/// Undoes [`begin_guard`].
///
/// # Safety
/// Only behind it.
unsafe fn end_guard() {
    // SAFETY: as above.
    unsafe {
        asm!("dsb", "isb");
        CCR.write_volatile(CCR.read_volatile() & !BFHFNMIGN);
        asm!("dsb", "isb");
        asm!("cpsie f");
    }
}

/// Does `read`; `None` when it met a word that cannot be corrected. Every interrupt waits meanwhile: some microseconds
/// for the few bytes that are read at once.
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
