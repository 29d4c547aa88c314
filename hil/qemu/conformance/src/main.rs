//! Logs how a Cortex-M core runs exceptions, floats and the control laws.
//!
//! Equal logs of one ELF on QEMU and on the emulated core verify that core. The host runs the laws alone: with equal
//! lines, host tests hold for the chip.
//!
//! A line is `<group>: <result>`; long results are hashed, short ones spelled out to locate a difference.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod core_under_test;
mod laws;
#[cfg(target_os = "none")]
mod machine;
#[cfg(target_os = "none")]
mod traces;

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
