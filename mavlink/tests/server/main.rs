//! The server as a ground station sees it.

mod budget;
mod commands;
mod inputs;
mod messages;
mod parameters;
mod signing;
mod station;
mod texts;
mod wire;
