//! Recordings of any kind, of others too.

mod any;
#[cfg(unix)]
mod pipes;
mod recordings;
