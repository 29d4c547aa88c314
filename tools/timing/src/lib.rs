//! Timing from a board's log. [`source`] reads files; [`live`] has every firmware's records, [`trace`] executor events
//! of one with the feature `trace`, [`capture::Capture`] both. [`table`], [`csv`] and [`page`] show it, [`analyse`]
//! bounds the deadlines.

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
