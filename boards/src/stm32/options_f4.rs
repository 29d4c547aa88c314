//! Option bytes of the F4 and F7.

use embassy_stm32::pac::FLASH;
use embassy_time::{Duration, Instant};

/// Brown-out level 3: two bits counting downwards, all ones for none (RM0090 §3.7.1, RM0410 §3.4.1).
const HIGHEST: u8 = 0b00;
/// Option byte keys (RM0090 §3.9.4, RM0410 §3.7.3).
const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
/// Time-out of a write; the option bytes are a sector of 16 KiB, 0.5 s at most (datasheets).
const LONGEST: Duration = Duration::from_secs(2);
/// Read-out protection: off, and irreversible.
const OPEN: u8 = 0xAA;
const SEALED: u8 = 0xCC;

/// Supply voltage of the reset at brown-out level 3, V (datasheets, VBOR3 falling, typical 2.83).
pub const BROWN_OUT_VOLTS: f32 = 2.8;

/// Brown-out level, 0 (off) to 3.
pub fn brown_out_level() -> u8 {
    3 - FLASH.optcr().read().bor_lev()
}

/// Read-out protection level.
pub fn read_protection() -> u8 {
    match FLASH.optcr().read().rdp() {
        OPEN => 0,
        SEALED => 2,
        _ => 1,
    }
}

/// Write-protected sectors, one bit each.
pub fn write_protected() -> u32 {
    let r = FLASH.optcr().read();
    let free = u32::from(r.n_wrp());
    !free & MASK
}

/// Sectors with such a bit.
const MASK: u32 = if cfg!(family = "f4") { 0xFFF } else { 0xFF };

/// Sets brown-out level 3; false if the flash rejects it.
pub fn set_brown_out() -> bool {
    if !ready() {
        return false;
    }
    for key in KEYS {
        FLASH.optkeyr().write_value(key);
    }
    FLASH.optcr().modify(|w| w.set_bor_lev(HIGHEST));
    FLASH.optcr().modify(|w| w.set_optstrt(true));
    let done = ready();
    FLASH.optcr().modify(|w| w.set_optlock(true));
    done && brown_out_level() == 3
}

fn ready() -> bool {
    let start = Instant::now();
    while FLASH.sr().read().bsy() {
        if start.elapsed() > LONGEST {
            return false;
        }
    }
    true
}
