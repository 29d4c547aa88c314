//! The concurrent tasks of the SOPHIE flight stack.
//!
//! Each task is a plain `async fn` over borrowed [`links::Links`] and a port of [`sophie_ports`]: the firmware wraps
//! it in a static task, the host spawns it on its own executor. No task owns a global. Level, period and deadline of each
//! are declared in [`schedule`], its messages in [`links`].
//!
//! From the ground up: [`schedule`] and [`start`], [`links`], [`deadline`] and [`supervision`], then the rooms of tasks.
//! [`deadline`] lies beside `schedule`, not in it, as it records over the links, which know the schedule.

#![no_std]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic
)]
// Tests compare exactly where exactness is the point.
#![cfg_attr(not(test), deny(clippy::float_cmp))]
#![allow(
    async_fn_in_trait,
    reason = "ports are awaited in place; no caller needs a Send bound"
)]

pub mod console;
pub mod deadline;
pub mod flight;
pub mod ground_station;
pub mod links;
pub mod navigation;
pub mod perching;
pub mod pilot;
pub mod schedule;
pub mod start;
pub mod storage;
pub mod supervision;
pub mod usb;
