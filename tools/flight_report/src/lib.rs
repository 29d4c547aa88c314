//! Output of a flight: page, log for plots, summary for programs, terminal.

mod approach;
mod attitude_error;
mod bands;
mod drawing;
mod figure;
mod figures;
mod grip_figure;
pub mod log;
mod moments;
pub mod page;
mod plot;
mod rotation;
mod scene;
mod schemas;
pub mod summary;
#[cfg(test)]
mod synthetic;
mod tables;
pub mod terminal;
mod thinning;
mod time_axis;
mod time_stamp;
