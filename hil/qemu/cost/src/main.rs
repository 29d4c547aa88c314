//! Counts the instructions of every stage of the control path, for each call, on the core that it is built for.
//!
//! It runs under QEMU with `-icount shift=7`: an instruction lasts 128 ns there, 3.2 ticks of the board's timer, so a
//! difference of two readings gives the number of instructions between them exactly. Instructions, not cycles: what
//! a cache, a flash or a division's fourteen cycles cost is not in it.
//!
//! Every stage is a call of its own, from memory to memory, fed with what the stage before it gave; then the whole
//! step is counted on the same inputs and must give the same motor commands. On the host only those are
//! printed, for comparison.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod chain;
mod counter;
mod inputs;
mod run;

#[cfg(not(target_os = "none"))]
fn main() {
    run::run(&mut |line| println!("{line}"));
}

#[cfg(target_os = "none")]
#[cortex_m_rt::entry]
fn main() -> ! {
    use cortex_m_semihosting::{debug, hprintln};

    run::run(&mut |line| hprintln!("{}", line));
    loop {
        debug::exit(debug::EXIT_SUCCESS);
    }
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
