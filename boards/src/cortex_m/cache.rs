//! Caches of a Cortex-M7, and the memory protection that they need.

use cortex_m::peripheral::{MPU, Peripherals, SCB};

/// Protection regions: base, memory type and access (ARMv7-M B3.5.8, B3.5.9). The default map (B3.1) without access to
/// external memories, even speculative, and without caching of data memories. The background map (privileged code only)
/// would serve for the rest, but the emulator checks it at each access.
const MAP: [(u32, u32); 4] = [
    // All addresses but the eighths below 0x6000_0000 and from 0xE000_0000 on.
    (0, NEVER_EXECUTED | 0x87 << 8 | SIZE_4_GB | ENABLED),
    (CODE, FULL_ACCESS | WRITTEN_THROUGH | SIZE_512_MB | ENABLED),
    (DATA, FULL_ACCESS | NEVER_CACHED | SIZE_512_MB | ENABLED),
    (PERIPHERALS, FULL_ACCESS | DEVICE | SIZE_512_MB | ENABLED),
];
/// Flash and instruction memory.
const CODE: u32 = 0x0000_0000;
/// Tightly coupled memory (uncached) and DMA's memories.
const DATA: u32 = 0x2000_0000;
const PERIPHERALS: u32 = 0x4000_0000;
const NEVER_EXECUTED: u32 = 1 << 28;
const FULL_ACCESS: u32 = 0b011 << 24;
const WRITTEN_THROUGH: u32 = 1 << 17;
const NEVER_CACHED: u32 = 0b001 << 19;
const DEVICE: u32 = NEVER_EXECUTED | 1 << 16;
const SIZE_4_GB: u32 = 31 << 1;
const SIZE_512_MB: u32 = 28 << 1;
const ENABLED: u32 = 1;
/// Protection on, default map elsewhere.
const ON: u32 = 1 << 2 | 1;

/// Enables the instruction cache, and with `data` the data cache, for reads from flash; blocks speculative reads of
/// external memories, where a controller not set up may stall the core. Called once, at the start.
pub fn enable_caches(data: bool) {
    // SAFETY: nothing else uses the core's cache control and memory protection, and nothing else runs yet.
    let mut core = unsafe { Peripherals::steal() };
    protect(&core.MPU);
    core.SCB.enable_icache();
    if data {
        core.SCB.enable_dcache(&mut core.CPUID);
    }
}

fn protect(mpu: &MPU) {
    cortex_m::asm::dmb();
    for (number, (base, attributes)) in (0..).zip(MAP) {
        // SAFETY: the core's own registers; one write enables a region with its attributes.
        unsafe {
            mpu.rnr.write(number);
            mpu.rbar.write(base);
            mpu.rasr.write(attributes);
        }
    }
    // SAFETY: as above; every address in use is in a region with full access, and no cache is on yet.
    unsafe { mpu.ctrl.write(ON) };
    cortex_m::asm::dsb();
    cortex_m::asm::isb();
}

/// Drops cached data that changed behind the cache.
pub fn forget_cached(address: usize, length: usize) {
    if SCB::dcache_enabled() {
        // SAFETY: cache control is the core's own, and dropping cached flash loses no write: flash is never written
        // through the cache.
        let mut core = unsafe { Peripherals::steal() };
        core.SCB.clean_invalidate_dcache_by_address(address, length);
    }
}

/// Every region is as set.
pub fn protected() -> bool {
    // SAFETY: this only selects the region to read, and nothing else uses the protection's registers.
    let mpu = unsafe { &*MPU::PTR };
    let regions = (0..).zip(MAP).all(|(number, (base, attributes))| {
        // SAFETY: as above.
        unsafe { mpu.rnr.write(number) };
        mpu.rbar.read() & !0x1F == base && mpu.rasr.read() == attributes
    });
    regions && mpu.ctrl.read() & ON == ON
}

/// State of instruction and data cache.
pub fn enabled() -> [bool; 2] {
    [SCB::icache_enabled(), SCB::dcache_enabled()]
}
