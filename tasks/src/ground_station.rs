//! MAVLink to ground stations, and the console that it carries.

pub mod console_pipe;
pub mod mavlink;
