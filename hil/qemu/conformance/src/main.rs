//! What a Cortex-M core does with exceptions, floats and the control laws, as a log of lines.
//!
//! The same ELF runs on QEMU and on the emulated core that flies the firmware; equal logs are the second opinion on
//! that core. On the host only the laws run, and print the same lines: the tests of the control laws there are tests of
//! what flies.
//!
//! A line is `<group>: <what it gave>`; long results are folded into a hash, short ones are spelled out, so that
//! two logs that differ say where.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod core_under_test;
mod laws;
#[cfg(target_os = "none")]
mod machine;

#[cfg(not(target_os = "none"))]
fn main() {
    laws::run(&mut |line| println!("{line}"));
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use cortex_m_semihosting::{debug, hprintln};

    let mut print = |line: core::fmt::Arguments<'_>| hprintln!("{}", line);
    laws::run(&mut print);
    core_under_test::run(&mut print);
    core_under_test::faults::run(&mut print, || {
        loop {
            debug::exit(debug::EXIT_SUCCESS);
        }
    })
}

#[cfg(target_os = "none")]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    use cortex_m_semihosting::{debug, hprintln};

    hprintln!("{}", info);
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}
