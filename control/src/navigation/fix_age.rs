//! Up to which age of the newest fix an estimate serves what.

/// Age of the newest fix with which a hold may begin, s: ten missing at 50 Hz.
pub const FRESH_AGE: f32 = 0.2;
/// Age up to which the inertial sensor alone carries the position, s: centimetres off.
pub const COAST_AGE: f32 = 1.0;
/// Age up to which an approach goes on, s: a module's longest gap, and what it is late.
pub const APPROACH_AGE: f32 = 1.3;
/// Age up to which it carries the height, s: some decimetres off. Then the pilot has the throttle.
pub const HEIGHT_AGE: f32 = 4.0;
/// The same with the pressure of the air for the height, s: within [`LOST_AGE`](super::position_estimator::LOST_AGE), with which the estimate ends.
pub const PRESSURE_AGE: f32 = 9.0;
