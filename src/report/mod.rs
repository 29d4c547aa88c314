//! What is kept of a flight on disk: a page to read, a log to plot, a summary for programs.

mod drawing;
mod figures;
pub mod log;
mod moments;
pub mod page;
mod plot;
mod scene;
mod schemas;
pub mod summary;
mod svg;
#[cfg(test)]
mod synthetic;
mod tables;
pub mod units;
