//! Each task by itself, on ports that do as they are told, in virtual time.

mod analog;
mod clamp;
mod commander;
mod console;
mod control;
mod deadline;
#[path = "../../../hil/tests/fakes/mod.rs"]
mod fakes;
mod imu;
mod keeper;
mod links;
mod mixer;
mod rig;
mod servos;
mod supervisor;
mod timing;
