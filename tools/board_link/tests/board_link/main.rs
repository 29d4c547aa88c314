//! Sessions and vehicles over lines that fail.

mod line;
mod vehicle;
