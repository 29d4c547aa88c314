//! What the handlers of the boards' faults want of a board, where there is none.

#![allow(
    unsafe_code,
    reason = "the handlers that fly are in here; each use has its reason beside it"
)]

use core::sync::atomic::Ordering::Relaxed;

use crate::core_under_test::faults;

/// Says so.
pub fn stop_motors() {
    faults::STOPPED.store(true, Relaxed);
}

pub mod cortex_m;
