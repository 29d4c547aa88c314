//! The ports of the SOPHIE flight stack: what a board implements and a driver gives, and the messages that pass through.
//!
//! Drivers and tasks meet here and do not know each other. Every unit is SI unless said otherwise.

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
