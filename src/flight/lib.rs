//! The tasks of the flight level and the steady level as static, non-generic executor tasks on a board's ports.
//!
//! A package of its own, since generic code and futures are compiled with the package that makes them concrete, at its
//! level of optimisation: these for speed, everything else of the firmware for size (`Cargo.toml`). `sophie_tasks` has
//! their code, `sophie_tasks::schedule` their levels.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod tasks;
