//! Contact with the pipe or the ground: contact force, friction limit, lean, slip, fall.

pub mod contact_force;
pub(crate) mod crown_offset;
pub(crate) mod fall;
pub mod friction_limit;
pub(crate) mod lean;
pub(crate) mod slip;
