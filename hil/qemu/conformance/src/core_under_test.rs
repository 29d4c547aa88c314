//! Instructions and exceptions, which only the target's core can show.

#![allow(
    unsafe_code,
    reason = "the core's own instructions and registers are what is tested; each use has its reason beside it"
)]

mod exceptions;
pub mod faults;
mod float;

use core::fmt::Arguments;

pub fn run(print: &mut dyn FnMut(Arguments<'_>)) {
    float::run(print);
    exceptions::run(print);
}
