//! Test stands: parts of the vehicle under given inputs, without a mission or a pilot.

pub mod arm_stand;
pub mod flight_level;
pub mod phone;
pub mod scale;
pub mod sled;
pub mod thrust_stand;
pub mod twist_stand;
