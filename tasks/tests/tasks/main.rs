//! Each task alone, on scripted ports, in virtual time.

mod analog;
mod arms;
mod bench;
mod calibrate;
mod clamp;
mod commander;
mod console;
mod consoles;
mod control;
mod deadline;
mod declarations;
mod fake_bus;
mod imu;
mod last_value;
mod links;
mod mavlink;
mod mixer;
mod parameters;
mod pilot_page;
mod position;
mod retained_store;
mod rig;
mod servos;
mod supervisor;
mod timing;
mod usb;
