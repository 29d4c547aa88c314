//! The MAVLink 2 server of the vehicle: takes bytes with the time of their arrival, gives frames to send.
//!
//! It does no I/O, allocates nothing and is not generic, so that it is compiled once and for size: a task
//! (`sophie_tasks::mavlink`) fills in the [`vehicle::Vehicle`] and moves the bytes. `docs/mavlink.md` has the messages.

#![no_std]
// The generated messages ask for features of the generator's own crate, which there are not here.
#![allow(unexpected_cfgs)]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic
)]

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
pub mod inputs;
pub mod server;
pub mod services;
pub mod vehicle;
pub mod wire;

pub use self::server::{Order, Server};
pub use self::services::commands::orders::Requests;
pub use self::vehicle::{Answers, Condition, Vehicle};
pub use self::wire::signing::Signing;
