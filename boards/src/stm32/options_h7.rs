//! Option bytes of the H7.

use embassy_stm32::pac::FLASH;
use embassy_time::{Duration, Instant};

/// Brown-out level 3: two bits counting upwards, zero for none (RM0433 §4.9.8).
const HIGHEST: u8 = 0b11;
/// Option byte keys (RM0433 §4.5.1).
const KEYS: [u32; 2] = [0x0819_2A3B, 0x4C5D_6E7F];
/// Time-out of a write, as on the F7: no datasheet of the H7 states one.
const LONGEST: Duration = Duration::from_secs(2);
/// Read-out protection: off, and irreversible.
const OPEN: u8 = 0xAA;
const SEALED: u8 = 0xCC;

/// Supply voltage of the reset at brown-out level 3, V (STM32H743 datasheet, VBOR3 falling, typical: 2.61).
pub const BROWN_OUT_VOLTS: f32 = 2.6;

/// Brown-out level, 0 (off) to 3.
pub fn brown_out_level() -> u8 {
    FLASH.optsr_cur().read().bor_lev()
}

/// Read-out protection level.
pub fn read_protection() -> u8 {
    match FLASH.optsr_cur().read().rdp() {
        OPEN => 0,
        SEALED => 2,
        _ => 1,
    }
}

/// Write-protected sectors, one bit each: bank 1, then bank 2.
pub fn write_protected() -> u32 {
    let [one, two] = [0, 1].map(|bank| !u32::from(FLASH.bank(bank).wpsn_curr().read().wrpsn()) & 0xFF);
    one | two << 8
}

/// Sets brown-out level 3; false if the flash rejects it.
pub fn set_brown_out() -> bool {
    if !ready() {
        return false;
    }
    for key in KEYS {
        FLASH.optkeyr().write_value(key);
    }
    FLASH.optsr_prg().modify(|w| w.set_bor_lev(HIGHEST));
    FLASH.optcr().modify(|w| w.set_optstart(true));
    let done = ready();
    FLASH.optcr().modify(|w| w.set_optlock(true));
    done && !FLASH.optsr_cur().read().optchangeerr() && brown_out_level() == 3
}

fn ready() -> bool {
    let start = Instant::now();
    while FLASH.optsr_cur().read().opt_busy() {
        if start.elapsed() > LONGEST {
            return false;
        }
    }
    true
}
