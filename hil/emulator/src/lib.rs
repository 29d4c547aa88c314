//! Flies the flashed image: an emulated board in closed loop with SOPHIE's simulated vehicle.
//!
//! ```text
//! plant ─> sensors ─> wires ─┐                 ┌─> pins ─> motor controllers, servos ─> plant
//! pilot ─> radio ──────────> emulated board (ELF) ─> telemetry ─> pilot
//!                                              └─> log
//! ```
//!
//! The image and the simulation are connected only by registers and wires, pins, telemetry and log.

/// Permitted instructions per clock cycle.
pub const SPEEDS: std::ops::RangeInclusive<f64> = 0.25..=1.0;

pub mod arguments;
pub mod bench_operator;
pub mod board_kind;
mod boards;
pub mod chain;
mod chips;
pub mod closed_loop;
pub mod compare;
pub mod elf;
pub mod emulator;
pub mod esc;
pub mod flight;
pub mod flyable;
pub mod gaps;
pub mod loader;
pub mod log;
pub mod plan;
mod processor;
pub mod sensors;
pub mod silicon;
pub mod stored;
pub mod suite;
pub mod terminal;
pub mod tilt;
pub mod wires;
