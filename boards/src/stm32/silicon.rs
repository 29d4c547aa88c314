//! Start-up checks of the chip: what the board's datasheets do not state, and traces of a failed start, another chip
//! revision or foreign option bytes.

use core::fmt::{self, Write};

use embassy_stm32::{pac, rcc};
use heapless::String;
use sophie_control::arming::ArmingInhibit;
use sophie_ports::chip_check::{ChipCheck, ChipChecks, READ, REVISION};
use sophie_ports::storage::Loaded;

use super::clock::bus_hz;
use super::options;

/// Checks the chip. `stored` is the result of reading the parameters, `sectors` a bit for each of their flash sectors.
/// Called once, with clocks and caches set.
pub fn look(stored: Loaded, sectors: u32) -> ChipChecks {
    let mut checks = ChipChecks::new();
    let mut add = |look| {
        let _ = checks.push(look);
    };
    add(revision());
    add(clocks());
    add(wait_states());
    add(acceleration());
    #[cfg(not(family = "f4"))]
    add(memory_protection());
    let level = options::brown_out_level();
    add(ChipCheck {
        inhibits: Some(ArmingInhibit::BrownOutLevel),
        ..row("brown-out level", format_args!("{level}"), "3", level == 3)
    });
    let level = options::read_protection();
    add(row(
        "read-out protection",
        format_args!("level {level}"),
        "level 0: a probe can read",
        level == 0,
    ));
    if sectors != 0 {
        let free = options::write_protected() & sectors == 0;
        let read = if free { "writable" } else { "write-protected" };
        add(row("parameter sectors", format_args!("{read}"), "writable", free));
    }
    let owner = match stored {
        Loaded {
            foreign: Some(other), ..
        } => other,
        Loaded { unreadable: true, .. } => "damaged, or unknown data",
        _ => "nobody else",
    };
    add(row(
        "stored data of",
        format_args!("{owner}"),
        "nobody else: 'save' replaces it",
        stored.foreign.is_none() && !stored.unreadable,
    ));
    checks
}

/// A check that permits flight.
fn row(name: &'static str, read: fmt::Arguments<'_>, expected: &'static str, ok: bool) -> ChipCheck {
    let mut text = String::<READ>::new();
    let _ = text.write_fmt(read);
    ChipCheck {
        name,
        read: text,
        expected,
        ok,
        inhibits: None,
    }
}

/// A check that forbids arming on failure.
fn needed(name: &'static str, read: fmt::Arguments<'_>, expected: &'static str, ok: bool) -> ChipCheck {
    ChipCheck {
        inhibits: Some(ArmingInhibit::Silicon),
        ..row(name, read, expected, ok)
    }
}

/// Before revision X the H7's converter must run slower than here, with its clocks set differently (STM32H743 errata,
/// RM0433 §60.5.8).
#[cfg(family = "h7")]
fn revision() -> ChipCheck {
    let id = pac::DBGMCU.idc().read();
    let (part, revision) = (id.dev_id(), id.rev_id());
    needed(
        REVISION,
        format_args!("{part:#x} {revision:#x}"),
        "0x2001 (X) or later",
        revision >= 0x2001,
    )
}

#[cfg(not(family = "h7"))]
fn revision() -> ChipCheck {
    let id = pac::DBGMCU.idcode().read();
    let (part, revision) = (id.dev_id(), id.rev_id());
    needed(REVISION, format_args!("{part:#x} {revision:#x}"), "any", true)
}

/// Core clock in MHz, from the PLL on the crystal, not the fallback oscillator.
fn clocks() -> ChipCheck {
    let mhz = bus_hz() / 1_000_000;
    let r = pac::RCC;
    let by_pll = r.cfgr().read().sws() == rcc::Sysclk::PLL1_P;
    #[cfg(family = "h7")]
    let locked = r.cr().read().pllrdy(0) && r.cr().read().pllrdy(1);
    #[cfg(not(family = "h7"))]
    let locked = r.cr().read().pllrdy();
    let ok = by_pll && locked && r.cr().read().hserdy();
    let source = if ok { "PLL on crystal" } else { "not the PLL" };
    needed(
        "bus clock",
        format_args!("{mhz} MHz, {source}"),
        "PLL on crystal",
        ok,
    )
}

/// At 2.7 V or more: one for each 30 MHz beyond the first on F4 and F7 (RM0090 table 10, RM0410 table 7), two from 140
/// to 210 MHz on the H7 (RM0433 table 17, VOS1).
fn wait_states() -> ChipCheck {
    #[cfg(family = "h7")]
    let read = pac::FLASH.acr().read().latency();
    #[cfg(not(family = "h7"))]
    let read = pac::FLASH.acr().read().latency().to_bits();
    let step = if cfg!(family = "h7") {
        70_000_000
    } else {
        30_000_000
    };
    let needs = bus_hz().saturating_sub(1) / step;
    needed(
        "flash wait states",
        format_args!("{read} of {needs}"),
        "as many as the clock needs",
        u32::from(read) >= needs,
    )
}

#[cfg(family = "f4")]
fn acceleration() -> ChipCheck {
    let [prefetch, instructions, data] = super::accelerator::enabled();
    let mark = |on| if on { "+" } else { "-" };
    needed(
        "flash acceleration",
        format_args!(
            "prefetch{} I{} D{}",
            mark(prefetch),
            mark(instructions),
            mark(data)
        ),
        "prefetch+ (- on rev. A) I+ D+",
        prefetch == super::accelerator::has_prefetch() && instructions && data,
    )
}

#[cfg(not(family = "f4"))]
fn acceleration() -> ChipCheck {
    let [instructions, data] = crate::cortex_m::caches();
    let mark = |on| if on { "+" } else { "-" };
    needed(
        "caches",
        format_args!("I{} D{}", mark(instructions), mark(data)),
        if crate::DATA_CACHE { "I+ D+" } else { "I+ D-" },
        instructions && data == crate::DATA_CACHE,
    )
}

#[cfg(not(family = "f4"))]
fn memory_protection() -> ChipCheck {
    let on = crate::cortex_m::protected();
    let read = if on { "external memories shut" } else { "off" };
    needed(
        "memory protection",
        format_args!("{read}"),
        "external memories shut",
        on,
    )
}
