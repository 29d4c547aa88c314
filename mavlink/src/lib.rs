//! The MAVLink 2 server of the vehicle: takes bytes with the time of their arrival, gives frames to send.
//!
//! It does no I/O, allocates nothing and is not generic, so that it is compiled once and for size: a task
//! (`sophie_tasks::ground_station::mavlink`) fills in the [`vehicle::Vehicle`] and moves the bytes. `docs/mavlink.md` has
//! the messages.

#![no_std]
#![deny(
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic
)]

pub mod inputs;
pub mod server;
pub mod services;
pub mod vehicle;
pub mod wire;

pub use self::server::{Order, Server};
pub use self::services::commands::orders::Requests;
pub use self::vehicle::{Answers, Condition, Vehicle};
pub use self::wire::signing::Signing;
