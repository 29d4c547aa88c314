//! The mode logic: a vehicle in a world of two switches ([`rig`]), a flight without trouble ([`mission`]), and every
//! trouble.

mod actuator_tests;
mod auto_perch;
mod diagram;
mod docs;
mod hand_over;
mod holding;
mod landing_point;
mod leaving;
mod letting_go;
mod losses;
mod mission;
mod pilot_page;
mod random;
mod reasons;
mod remote;
mod restart;
mod rig;
mod trouble;
