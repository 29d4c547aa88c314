//! Vehicles over lines that fail.

mod vehicle;
