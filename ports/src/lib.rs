//! The ports of the SOPHIE flight stack: interfaces that boards and drivers implement, and the messages that pass
//! through.
//!
//! Drivers and tasks both depend on this crate and not on each other. Units are SI unless noted.

#![no_std]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_cmp
)]
#![allow(
    async_fn_in_trait,
    reason = "ports are awaited in place; no caller needs a Send bound"
)]

pub mod actuators;
pub mod chip;
pub mod chip_check;
pub mod data_ready;
pub mod error;
pub mod external_pose;
pub mod receiver;
pub mod retained;
pub mod sensors;
pub mod serial;
pub mod signing;
pub mod stack_use;
pub mod storage;
