//! The tasks of the steady level, 500 Hz and less, as static, non-generic executor tasks on a board's ports.
//!
//! A package of its own, compiled for size: generic code and futures are compiled with the package that makes them
//! concrete, at its level of optimisation (`Cargo.toml`), and `sophie_flight` has the flight level's for speed.
//! `sophie_tasks` has their code, `sophie_tasks::schedule` their levels.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod tasks;
