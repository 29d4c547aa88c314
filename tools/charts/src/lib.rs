//! Parts of pages with drawings: [`svg`], [`ticks`], the common [`STYLE`], and [`units`] for readers.

pub mod svg;
pub mod ticks;
pub mod units;

/// The style sheet of every page.
pub const STYLE: &str = include_str!("style.css");
