//! The MAVLink 2 server of the vehicle: takes bytes with the time of their arrival, gives frames to send.
//!
//! It does no I/O, allocates nothing and is not generic, so that it is compiled once and for size: a task
//! (`sophie_tasks::ground_station::mavlink`) fills in the [`vehicle::Vehicle`] and moves the bytes. `docs/mavlink.md` has
//! the messages.

#![no_std]
// The generated messages ask for features of the generator's own crate, which there are not here.
#![allow(unexpected_cfgs)]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic
)]

pub mod budget;
#[allow(
    missing_docs,
    non_camel_case_types,
    clippy::all,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    reason = "generated"
)]
pub mod dialect;
pub mod files;
pub mod frame;
pub mod ftp;
pub mod inputs;
pub mod messages;
pub mod parameters;
pub mod parser;
pub mod requests;
pub mod server;
pub mod signing;
pub mod sorter;
pub mod streams;
pub mod texts;
pub mod vehicle;

pub use self::server::{Order, Requests, Server};
pub use self::signing::Signing;
pub use self::vehicle::{Answers, Condition, Vehicle};
