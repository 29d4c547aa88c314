//! Timing from a board's log.
//!
//! [`source`] turns any file into messages; [`live`] reads the records that every firmware logs each second, [`trace`]
//! the executor events of one built with the feature `trace`; [`capture::Capture`] is both. [`table`], [`csv`] and
//! [`page`] show it, [`analyse`] bounds the deadlines.

#![deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod analyse;
pub mod capture;
pub mod csv;
pub mod live;
pub mod page;
pub mod replay;
pub mod rta;
pub mod source;
pub mod stats;
pub mod table;
pub mod trace;
