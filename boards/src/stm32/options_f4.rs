//! The option bytes of the F4 and F7.

use embassy_stm32::pac::FLASH;
use embassy_time::{Duration, Instant};

/// What stands for brown-out level 3 here: two bits that count downwards, all ones for none (RM0090 §3.7.1, RM0410
/// §3.4.1). The H7 counts upwards.
const HIGHEST: u8 = 0b00;
/// Keys of the option bytes (RM0090 §3.9.4, RM0410 §3.7.3).
const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
/// Longest write. Datasheets: the option bytes are a sector of 16 KiB, 0.5 s at the most.
const LONGEST: Duration = Duration::from_secs(2);
/// Read-out protection: off, and what can never be undone.
const OPEN: u8 = 0xAA;
const SEALED: u8 = 0xCC;

/// Supply voltage below which brown-out level 3 holds the chip in reset, V (datasheets, VBOR3 falling, typical 2.83).
pub const BROWN_OUT_VOLTS: f32 = 2.8;

/// The brown-out level, 0 (off) to 3.
pub fn brown_out_level() -> u8 {
    3 - FLASH.optcr().read().bor_lev()
}

/// The level of the read-out protection.
pub fn read_protection() -> u8 {
    match FLASH.optcr().read().rdp() {
        OPEN => 0,
        SEALED => 2,
        _ => 1,
    }
}

/// Sectors that are protected from writes, a bit each.
pub fn write_protected() -> u32 {
    let r = FLASH.optcr().read();
    let free = u32::from(r.n_wrp());
    !free & MASK
}

/// Sectors that have such a bit.
const MASK: u32 = if cfg!(family = "f4") { 0xFFF } else { 0xFF };

/// Sets brown-out level 3; false when the flash does not take it.
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

/// Waits until the flash has nothing to do; false when that lasts too long.
fn ready() -> bool {
    let start = Instant::now();
    while FLASH.sr().read().bsy() {
        if start.elapsed() > LONGEST {
            return false;
        }
    }
    true
}
