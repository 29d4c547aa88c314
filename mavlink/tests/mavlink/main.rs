//! The server as a ground station sees it, and the files that are made for ground stations.

mod budget;
mod calibration;
mod commands;
mod definitions;
mod inputs;
mod messages;
mod metadata;
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
