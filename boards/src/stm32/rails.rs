//! Pins at fixed levels: from the first instructions those of the motors and of whatever a floating line would move,
//! sound or switch; also switches of supplies and chips.

use core::arch::global_asm;

use embassy_stm32::Peri;
use embassy_stm32::gpio::{AnyPin, Level, Output, Speed};
use embassy_stm32::pac;
use embassy_stm32::pac::gpio::Gpio;

use crate::FIRST_LEVELS;

/// Holds `pin` at `level` permanently: a dropped pin would float.
pub fn hold(pin: Peri<'static, AnyPin>, level: Level) {
    core::mem::forget(Output::new(pin, level, Speed::Low));
}

/// Pins of one port that are outputs, and their levels. The assembly below reads it by its offsets.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct PortLevels {
    port: *const (),
    /// Bits of MODER that are cleared, then those that are set.
    modes: u32,
    outputs: u32,
    /// What BSRR is given.
    levels: u32,
}

// SAFETY: the pointer is a port's address and is used by `drive_ports` alone.
unsafe impl Sync for PortLevels {}

impl PortLevels {
    /// The pins, 0 to 15, of a port that are low and those that are high.
    pub const fn new(port: Gpio, low: &[u32], high: &[u32]) -> Self {
        let (low, high) = (bits(low), bits(high));
        let outputs = every_second(low | high);
        Self {
            port: port.as_ptr(),
            modes: outputs * 0b11,
            outputs,
            levels: low << 16 | high,
        }
    }
}

const fn bits(mut pins: &[u32]) -> u32 {
    let mut bits = 0;
    while let [pin, others @ ..] = pins {
        assert!(*pin < 16, "a port has the pins 0 to 15");
        bits |= 1 << *pin;
        pins = others;
    }
    bits
}

/// Bit n of the lower half at bit 2 n: MODER has two bits a pin.
const fn every_second(bits: u32) -> u32 {
    let mut spread = 0;
    let mut pin = 0;
    while pin < 16 {
        spread |= (bits >> pin & 1) << (2 * pin);
        pin += 1;
    }
    spread
}

/// Makes the pins outputs at their levels, whatever drove them: for the motors a fault handler's last step.
pub fn drive(ports: &[PortLevels]) {
    // SAFETY: reads as many entries as there are; each holds a port's address, since `new` alone makes them.
    unsafe { drive_ports(ports.as_ptr(), ports.len()) }
}

static FIRST: [PortLevels; FIRST_LEVELS.len()] = FIRST_LEVELS;

unsafe extern "C" {
    #[link_name = "sophie_drive_ports"]
    fn drive_ports(first: *const PortLevels, count: usize);
}

/// The register that switches the ports' clocks: AHB4ENR of the H7 (RM0433), AHB1ENR of the others (RM0090, RM0410).
#[cfg(family = "h7")]
const CLOCKS: u32 = 0x5802_44E0;
#[cfg(not(family = "h7"))]
const CLOCKS: u32 = 0x4002_3830;

// `__pre_init` is what cortex-m-rt calls before it clears the memory, which takes 6 ms at the clock that a small chip
// starts with: in assembly, because Rust may not run before that.
//
// After the ports' clocks are on two cycles pass until they answer (RM0090 §7.2.14, RM0433 §8.5.10). Each level is set
// before the pin becomes an output.
global_asm!(
    ".pushsection .text.__pre_init, \"ax\"",
    ".global __pre_init",
    ".type __pre_init, %function",
    ".thumb_func",
    "__pre_init:",
    "ldr r0, ={first}",
    "movs r1, #{count}",
    ".global sophie_drive_ports",
    ".type sophie_drive_ports, %function",
    ".thumb_func",
    "sophie_drive_ports:",
    "ldr r2, ={clocks}",
    "ldr r3, [r2]",
    "orr r3, r3, #0xFF",
    "str r3, [r2]",
    "dsb",
    "ldr r3, [r2]",
    "cbz r1, 2f",
    "1:",
    "ldr r2, [r0]",
    "ldr r3, [r0, #12]",
    "str r3, [r2, #0x18]",
    "ldr r3, [r2]",
    "ldr r12, [r0, #4]",
    "bic r3, r3, r12",
    "ldr r12, [r0, #8]",
    "orr r3, r3, r12",
    "str r3, [r2]",
    "adds r0, #16",
    "subs r1, #1",
    "bne 1b",
    "2:",
    "bx lr",
    ".ltorg",
    ".popsection",
    first = sym FIRST,
    count = const FIRST_LEVELS.len(),
    clocks = const CLOCKS,
);
