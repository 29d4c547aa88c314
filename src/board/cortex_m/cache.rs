//! The caches of a Cortex-M7, and the memory protection that they need.

use cortex_m::peripheral::{MPU, Peripherals, SCB};

/// Region 0 of the memory protection: all addresses, of which the eighths below 0x6000_0000 and from 0xE000_0000 on are
/// left out; no access, not even by a speculative read (ARMv7-M B3.5.9).
const EXTERNAL: u32 = 1 << 28 | 0x87 << 8 | 31 << 1 | 1;
/// Protection on; the default map where no region is.
const ON: u32 = 1 << 2 | 1;

/// Switches the instruction cache on, and keeps the core from reading ahead at the addresses of external memories, where
/// a controller that was never set up may stall it for ever. Called once, at the start.
pub fn enable_instruction_cache() {
    // SAFETY: nothing else uses the core's cache control and memory protection, and nothing else runs yet.
    let mut core = unsafe { Peripherals::steal() };
    protect(&core.MPU, 0, 0, EXTERNAL);
    core.SCB.enable_icache();
}

/// Switches the data cache on too. Called once, behind [`enable_instruction_cache`].
///
/// Only for boards where everything that DMA moves lies in memory that is never cached: what DMA writes behind the cache
/// would have to be invalidated by hand. `cargo xtask firmware` checks where it lies.
#[allow(dead_code, reason = "each board has its own caches")]
pub fn enable_data_cache() {
    // SAFETY: as above.
    let mut core = unsafe { Peripherals::steal() };
    core.SCB.enable_dcache(&mut core.CPUID);
}

/// Makes `attributes` those of region `number` at `base`, and switches the protection on.
fn protect(mpu: &MPU, number: u32, base: u32, attributes: u32) {
    cortex_m::asm::dmb();
    // SAFETY: the registers are the core's own; the region is switched on with its attributes, in one write.
    unsafe {
        mpu.rnr.write(number);
        mpu.rbar.write(base);
        mpu.rasr.write(attributes);
        mpu.ctrl.write(ON);
    }
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Drops what the data cache keeps of `length` bytes at `address`, which were changed behind it.
pub fn forget_cached(address: usize, length: usize) {
    if SCB::dcache_enabled() {
        // SAFETY: the cache control is the core's own, and dropping what is cached of flash loses no write: it is never
        // written through the cache.
        let mut core = unsafe { Peripherals::steal() };
        core.SCB.clean_invalidate_dcache_by_address(address, length);
    }
}

/// The core does not read ahead at external memories.
pub fn protected() -> bool {
    // SAFETY: reading these registers changes nothing.
    unsafe { (*MPU::PTR).ctrl.read() & ON == ON && (*MPU::PTR).rasr.read() == EXTERNAL }
}

/// Instruction cache and data cache are on.
pub fn enabled() -> [bool; 2] {
    [SCB::icache_enabled(), SCB::dcache_enabled()]
}
