//! What tests of several packages share.

pub mod clients;
pub mod command;
pub mod flights;
pub mod signals;
