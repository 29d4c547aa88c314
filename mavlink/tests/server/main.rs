//! The server as a ground station sees it.

mod budget;
mod calibration;
mod commands;
mod inputs;
mod messages;
mod orders;
mod page;
mod parameters;
mod protocol_detector;
mod senders;
mod set_up;
mod shell;
mod signing;
mod station;
mod texts;
mod wire;
