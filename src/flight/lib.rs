//! The tasks of the flight level, 1 kHz, as static, non-generic executor tasks on a board's ports.
//!
//! A package of its own, since generic code and futures are compiled with the package that makes them concrete, at its
//! level of optimisation: these for speed, the steady level (`sophie_steady`) and the rest of the firmware for size (`Cargo.toml`). `sophie_tasks` has
//! their code, `sophie_tasks::schedule` their levels.

#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
pub mod tasks;
