//! Position, velocity and height, 100 Hz: inertial prediction, flow and range, external poses, barometer.

pub mod air_pressure;
pub(crate) mod axis_filter;
pub mod baro_height;
pub(crate) mod consistency;
pub mod estimate;
pub mod external_pose;
pub mod fix;
pub mod fix_age;
pub mod flow_range;
pub mod flow_range_sample;
pub(crate) mod frozen_range;
pub(crate) mod history;
pub mod inertial;
pub(crate) mod pipe_footprint;
pub(crate) mod pose_noise;
pub mod position_estimator;
pub mod range_hit;
pub(crate) mod range_scale;
pub(crate) mod settled_hits;
pub(crate) mod surface_step;
pub(crate) mod texture;
pub(crate) mod vertical_speed;
