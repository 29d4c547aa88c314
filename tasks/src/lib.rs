//! The concurrent tasks of the SOPHIE flight stack.
//!
//! Each task is a plain `async fn` over borrowed [`links::Links`] and a port of [`ports`]: the firmware wraps
//! it in a static task, the host spawns it on its own executor. No task owns a global. Level, period and deadline of each
//! are declared in [`schedule`], its messages in [`links`].

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

pub mod analog;
pub mod arms;
pub mod barometer;
pub mod clamp;
pub mod commander;
pub mod console;
pub mod control;
pub mod deadline;
pub mod estimator;
mod flow_limit;
pub mod ground;
pub mod histogram;
pub mod image_id;
pub mod imu;
pub mod last_value;
pub mod links;
pub mod mavlink;
pub mod mixer;
pub mod motors;
pub mod one_of;
pub mod parameters;
pub mod ports;
pub mod position;
pub mod rc;
pub mod retained_state;
pub mod retained_store;
pub mod schedule;
pub mod servos;
pub mod shell;
pub mod silence;
pub mod stack_use;
pub mod start;
pub mod storing;
pub mod supervisor;
pub mod telemetry;
pub mod terminals;
pub mod timing;
pub mod usb;
pub mod warning;
