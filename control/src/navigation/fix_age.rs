//! Limits of the age of the newest fix.

/// Age of the newest fix with which a hold may begin, s: ten missing at 50 Hz.
pub const FRESH_AGE: f32 = 0.2;
/// Age up to which the inertial sensor alone carries the position, s: centimetres off.
pub const COAST_AGE: f32 = 1.0;
/// Age up to which an approach goes on, s: a module's longest gap, and what it is late.
pub const APPROACH_AGE: f32 = 1.3;
/// Age up to which it carries the height, s: some decimetres off. Then the pilot has the throttle.
pub const HEIGHT_AGE: f32 = 4.0;
/// The same with the pressure of the air for the height, s: within [`LOST_AGE`].
pub const PRESSURE_AGE: f32 = 9.0;
/// Age of the newest fix with which the estimate ends, s: the inertial sensor alone is metres off by then.
pub const LOST_AGE: f32 = 10.0;
/// Silence of the poses after which one that is off is no jump, s: what was estimated since may be as far off.
pub const UNKNOWN_AGE: f32 = 1.0;
/// Age that an estimate has once its poses were found to disagree, µs: none coasts on by it (see
/// [`crate::mode::Mode::Hold`]).
pub const TAINTED_AGE: u64 = 1_310_000;
