//! Results as sections of text, tables and charts: as an HTML page, as JSON and on the terminal.

mod chart;
pub mod json;
pub mod model;
pub mod page;
pub mod text;
