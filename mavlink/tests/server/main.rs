//! The server as a ground station sees it.

mod budget;
mod calibration;
mod commands;
mod messages;
mod orders;
mod parameters;
mod station;
mod texts;
mod wire;
