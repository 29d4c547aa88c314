//! Order of events in nesting, priorities, masks, tail-chaining, faults, sleep, and floats across interrupts.
//!
//! Events: an interrupt's number at its handler's start, the negative number at its end; numbers from 1000 on are
//! lines of the scenario.

use core::arch::{asm, global_asm};
use core::fmt::{self, Arguments};
use core::sync::atomic::{AtomicI32, AtomicU32, AtomicUsize, Ordering::Relaxed};

use cortex_m::asm::{dsb, isb, sev, wfe, wfi};
use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::scb::{Exception, SystemHandler};
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m::register::{basepri, basepri_max, control};
use cortex_m_rt::exception;

const EVENTS: usize = 128;
/// The machines use the upper four and three bits.
const PRIORITIES: [(u16, u8); 7] = [
    (1, 0x40),
    (2, 0x20),
    (3, 0x60),
    (4, 0x60),
    (5, 0x00),
    (6, 0xE0),
    (7, 0x80),
];

static LOG: [AtomicI32; EVENTS] = [const { AtomicI32::new(0) }; EVENTS];
static LENGTH: AtomicUsize = AtomicUsize::new(0);
/// Pended by a handler once before its end; 0: none.
static CHAIN: [AtomicI32; 8] = [const { AtomicI32::new(0) }; 8];
/// Status of the last usage fault, and their number.
static FAULT_STATUS: AtomicU32 = AtomicU32::new(0);
static FAULTS: AtomicU32 = AtomicU32::new(0);

#[derive(Clone, Copy)]
struct Line(u16);

// SAFETY: interrupt numbers of both machines.
unsafe impl InterruptNumber for Line {
    fn number(self) -> u16 {
        self.0
    }
}

fn event(number: i32) {
    let at = LENGTH.fetch_add(1, Relaxed);
    if let Some(slot) = LOG.get(at) {
        slot.store(number, Relaxed);
    }
}

/// If enabled, it has run on return.
fn pend(line: u16) {
    NVIC::pend(Line(line));
    dsb();
    isb();
}

struct Events;

impl fmt::Display for Events {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for slot in LOG.iter().take(LENGTH.load(Relaxed)) {
            write!(f, " {}", slot.load(Relaxed))?;
        }
        Ok(())
    }
}

#[exception]
// SAFETY: only the processor calls it.
unsafe fn DefaultHandler(number: i16) {
    event(i32::from(number));
    if number % 2 == 1 {
        // SAFETY: it changes only registers that the processor saves for the interrupted code, or that a callee saves.
        unsafe { conformance_spoil_floats() };
    }
    let next = usize::try_from(number).ok().and_then(|n| CHAIN.get(n));
    if let Some(next) = next.map(|n| n.swap(0, Relaxed))
        && next > 0
    {
        pend(next as u16);
    }
    event(-i32::from(number));
}

#[exception]
fn SVCall() {
    event(900);
    pend(3);
    event(-900);
}

#[exception]
fn PendSV() {
    event(910);
    // SAFETY: as in `DefaultHandler`.
    unsafe { conformance_spoil_floats() };
    pend(5);
    event(-910);
}

#[exception]
fn SysTick() {
    event(920);
}

global_asm!(
    // Spoils caller-saved float registers.
    ".syntax unified",
    ".thumb_func",
    ".global conformance_spoil_floats",
    "conformance_spoil_floats:",
    ".fpu fpv4-sp-d16",
    "vpush {{s16-s31}}",
    "ldr r0, =0x7FC0BEEF",
    "vmov s0, r0",
    "vmov.f32 s1, s0",
    "vmov.f32 s2, s0",
    "vmov.f32 s7, s0",
    "vmov.f32 s15, s0",
    "vmov.f32 s16, s0",
    "vmov.f32 s31, s0",
    "mov r0, #0",
    "vmsr fpscr, r0",
    "vpop {{s16-s31}}",
    "bx lr",
    ".ltorg",
    // A usage fault skips its instruction, two or four bytes, and reports its kind.
    ".thumb_func",
    ".global UsageFault",
    "UsageFault:",
    "tst lr, #4",
    "ite eq",
    "mrseq r0, msp",
    "mrsne r0, psp",
    "ldr r1, [r0, #24]",
    "ldrh r2, [r1]",
    "lsrs r2, r2, #11",
    "cmp r2, #0x1D",
    "ite hs",
    "addhs r1, #4",
    "addlo r1, #2",
    "str r1, [r0, #24]",
    "b conformance_usage_fault",
    // Faulting code: a division by zero, an undefined instruction, a misaligned doubleword.
    ".thumb_func",
    ".global conformance_divide",
    "conformance_divide:",
    "movs r1, #7",
    "movs r2, #0",
    "udiv r0, r1, r2",
    "bx lr",
    ".thumb_func",
    ".global conformance_undefined",
    "conformance_undefined:",
    "udf #1",
    "bx lr",
    ".thumb_func",
    ".global conformance_unaligned",
    "conformance_unaligned:",
    "ldrd r2, r3, [r0]",
    "bx lr",
);

unsafe extern "C" {
    fn conformance_spoil_floats();
    fn conformance_divide() -> u32;
    fn conformance_undefined();
    fn conformance_unaligned(address: *const u8);
}

#[unsafe(no_mangle)]
extern "C" fn conformance_usage_fault() {
    // SAFETY: the fault status register, always present; writing back what was read clears it.
    let status = unsafe {
        let cfsr = 0xE000_ED28 as *mut u32;
        let status = cfsr.read_volatile();
        cfsr.write_volatile(status);
        status
    };
    FAULT_STATUS.store(status, Relaxed);
    FAULTS.fetch_add(1, Relaxed);
    event(930);
}

pub fn run(print: &mut dyn FnMut(Arguments<'_>)) {
    // SAFETY: the only place that takes them, and nothing runs beside it.
    let mut core = unsafe { cortex_m::Peripherals::steal() };
    for (line, priority) in PRIORITIES {
        // SAFETY: no critical section relies on these priorities.
        unsafe {
            core.NVIC.set_priority(Line(line), priority);
            NVIC::unmask(Line(line));
        }
    }
    // SAFETY: as above.
    unsafe {
        core.SCB.set_priority(SystemHandler::PendSV, 0xF0);
        core.SCB.set_priority(SystemHandler::SVCall, 0x50);
        core.SCB.set_priority(SystemHandler::SysTick, 0x90);
    }
    core.SCB.enable(Exception::UsageFault);

    let scenarios: [(&str, fn(&mut cortex_m::Peripherals)); 10] = [
        ("nesting", nesting),
        ("ties", ties),
        ("base priority", base_priority),
        ("fault mask", fault_mask),
        ("supervisor call", supervisor_call),
        ("floats across interrupts", floats),
        ("lazy float frame", lazy_frame),
        ("usage faults", usage_faults),
        ("sleep", sleep),
        ("read-back", read_back),
    ];
    for (name, scenario) in scenarios {
        LENGTH.store(0, Relaxed);
        scenario(&mut core);
        print(format_args!("{name}:{Events}"));
    }
}

fn nesting(_: &mut cortex_m::Peripherals) {
    chain(1, 2);
    chain(2, 4);
    pend(1);
    event(1000);
}

/// Released together: by priority, then by number.
fn ties(_: &mut cortex_m::Peripherals) {
    cortex_m::interrupt::disable();
    [7, 4, 3, 6, 1, 2, 5].into_iter().for_each(pend);
    event(1001);
    // SAFETY: no critical section is open.
    unsafe { cortex_m::interrupt::enable() };
    isb();
    event(1002);
}

fn base_priority(_: &mut cortex_m::Peripherals) {
    // SAFETY: no critical section relies on the base priority.
    unsafe { basepri::write(0x50) };
    [7, 4, 3, 1, 2].into_iter().for_each(pend);
    event(1003);
    // 0x80 is lower and ignored.
    basepri_max::write(0x80);
    event(i32::from(basepri::read()));
    // SAFETY: as above.
    unsafe { basepri::write(0x70) };
    isb();
    event(1004);
    // SAFETY: as above.
    unsafe { basepri::write(0) };
    isb();
    event(1005);
}

fn fault_mask(_: &mut cortex_m::Peripherals) {
    // SAFETY: sets and clears the fault mask; nothing relies on it.
    unsafe { asm!("cpsid f", options(nomem, nostack, preserves_flags)) };
    pend(5);
    event(1006);
    // SAFETY: as above.
    unsafe { asm!("cpsie f", options(nomem, nostack, preserves_flags)) };
    isb();
    event(1008);
}

/// PendSV runs last, though pended first.
fn supervisor_call(_: &mut cortex_m::Peripherals) {
    cortex_m::interrupt::disable();
    SCB::set_pendsv();
    SCB::set_pendst();
    // SAFETY: no critical section is open.
    unsafe { cortex_m::interrupt::enable() };
    isb();
    event(1009);
    // SAFETY: the handler above returns.
    unsafe { asm!("svc 0") };
    event(1010);
}

fn floats(_: &mut cortex_m::Peripherals) {
    let sum = |interrupted: bool| {
        let mut s = 0.0f32;
        for k in 1..=50u16 {
            let v = core::hint::black_box(1.5f32) * f32::from(k);
            if interrupted {
                NVIC::pend(Line(if k % 2 == 0 { 1 } else { 7 }));
                // Pended just before the next operation: the frame holds half a sum.
            }
            s += v / (s + 0.75);
            isb();
        }
        s
    };
    let alone = sum(false);
    let interrupted = sum(true);
    let events = LENGTH.swap(0, Relaxed);
    event(events as i32);
    event(alone.to_bits() as i32);
    event(interrupted.to_bits() as i32);
}

/// CONTROL.FPCA before and after an interrupt that uses floats.
fn lazy_frame(_: &mut cortex_m::Peripherals) {
    let active = || i32::from(control::read().fpca() == control::Fpca::Active);
    // SAFETY: clears the mark that floats are in use; none is live across it.
    unsafe {
        let mut c = control::read();
        c.set_fpca(control::Fpca::NotActive);
        control::write(c);
    }
    isb();
    event(1020 + active());
    pend(1);
    event(1020 + active());
    let x = core::hint::black_box(2.5f32) * core::hint::black_box(4.0f32);
    event(1020 + active());
    pend(7);
    event((x * 10.0) as i32);
    event(1020 + active());
}

fn usage_faults(core: &mut cortex_m::Peripherals) {
    let show = || {
        event(FAULT_STATUS.swap(0, Relaxed) as i32);
        event(FAULTS.swap(0, Relaxed) as i32);
    };
    // SAFETY: the handler skips the instruction.
    unsafe { conformance_undefined() };
    show();
    // SAFETY: a division by zero gives 0 while it is not trapped.
    event(unsafe { conformance_divide() } as i32);
    show();
    // SAFETY: traps divisions by zero; the handler skips them.
    unsafe { core.SCB.ccr.modify(|ccr| ccr | 1 << 4) };
    dsb();
    isb();
    // SAFETY: as above.
    unsafe { conformance_divide() };
    show();
    // SAFETY: ends the trap.
    unsafe { core.SCB.ccr.modify(|ccr| ccr & !(1 << 4)) };
    let words = [0u32; 4];
    // SAFETY: within `words`; the load faults, since doublewords must be aligned to four, and is skipped.
    unsafe { conformance_unaligned(words.as_ptr().cast::<u8>().add(2)) };
    show();
}

fn sleep(core: &mut cortex_m::Peripherals) {
    sev();
    wfe();
    event(1030);
    // A pending interrupt wakes while masked, and runs afterwards.
    cortex_m::interrupt::disable();
    pend(6);
    wfi();
    event(1031);
    // SAFETY: no critical section is open.
    unsafe { cortex_m::interrupt::enable() };
    isb();
    event(1032);
    // With SEVONPEND even a disabled interrupt wakes. SAFETY: sets SEVONPEND.
    unsafe { core.SCB.scr.modify(|scr| scr | 1 << 4) };
    NVIC::mask(Line(6));
    sev();
    wfe();
    pend(6);
    wfe();
    event(1033);
    NVIC::unpend(Line(6));
    // SAFETY: restores the former state.
    unsafe {
        core.SCB.scr.modify(|scr| scr & !(1 << 4));
        NVIC::unmask(Line(6));
    }
}

fn read_back(core: &mut cortex_m::Peripherals) {
    NVIC::mask(Line(6));
    pend(6);
    event(i32::from(NVIC::is_pending(Line(6))));
    event(i32::from(NVIC::is_enabled(Line(6))));
    event(i32::from(NVIC::is_active(Line(1))));
    event(i32::from(NVIC::get_priority(Line(3)) >> 5));
    event((core.SCB.icsr.read() & 0x1FF) as i32);
    NVIC::unpend(Line(6));
    event(i32::from(NVIC::is_pending(Line(6))));
}

fn chain(from: usize, to: i32) {
    if let Some(slot) = CHAIN.get(from) {
        slot.store(to, Relaxed);
    }
}
