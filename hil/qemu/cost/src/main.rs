//! Counts instructions per call of every stage of the control path on the target core.
//!
//! Under QEMU with `-icount shift=7` an instruction lasts 128 ns, 3.2 ticks of the board's timer: two readings give
//! their number exactly, without the cycles of caches, flash or a division (fourteen).
//!
//! Every stage is called on the previous output; the whole step, counted on the same inputs, must give the same motor
//! commands. The host prints only those.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod chain;
mod counter;
mod inputs;
mod position;
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
