//! The emulated boards: a microcontroller each, and its pads wired to sensors and lines.

pub(crate) mod f405;
pub(crate) mod h743;
pub(crate) mod wired;
