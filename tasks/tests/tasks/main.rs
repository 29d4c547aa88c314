//! Each task by itself, on scripted ports, in virtual time.

mod analog;
mod clamp;
mod commander;
mod console;
mod control;
mod deadline;
#[path = "../../../sim/tests/fakes/mod.rs"]
mod fakes;
mod imu;
mod links;
mod mixer;
mod newest;
mod retained_store;
mod rig;
mod servos;
mod supervisor;
mod timing;
