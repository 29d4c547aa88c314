//! The MAVLink 2 server of the vehicle: it takes received bytes with their time and makes frames to send.
//!
//! The line's bytes are in [`wire`], the services to ground stations in [`services`], the measurements of other
//! computers in [`inputs`]; a [`Server`] ties them together for one line. The crate does no I/O, allocates nothing and
//! is not generic, so that it is compiled once and for size: a task (`sophie_tasks::ground_station::mavlink`) fills in the
//! [`vehicle::Vehicle`] and moves the bytes. `docs/mavlink.md` has the messages.

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
pub use self::services::commands::orders::CommanderRequests;
pub use self::services::commands::report::{Report, Row};
pub use self::vehicle::{Answers, Condition, Vehicle};
pub use self::wire::signing::Signing;
