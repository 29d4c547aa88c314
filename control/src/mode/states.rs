//! The state of each mode, one file a mode: its fields, its setpoints, its displayed reason.

pub mod approach;
pub mod armed;
pub mod calibrating;
pub mod clamping;
pub mod contact;
pub mod disarmed;
pub mod escaping;
pub mod failsafe;
pub mod flight;
pub mod hold;
pub mod landed;
pub mod perched;
pub mod releasing;
