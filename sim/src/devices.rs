//! Devices beside the board and the lines to them: flow module, companion computer, radio protocols.

pub(crate) mod chip;
pub(crate) mod companion;
pub mod crsf;
pub mod flow_module;
pub(crate) mod line;
pub(crate) mod mavlink_server;
pub mod sbus;
pub(crate) mod storage;
