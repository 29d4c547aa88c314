//! Limits of the age of the newest fix.

/// Largest age of the newest fix at which a hold may begin, s: ten missing at 50 Hz.
pub const FRESH_AGE: f32 = 0.2;
/// Age up to which dead reckoning holds the position, s: centimetres off.
pub const COAST_AGE: f32 = 1.0;
/// Age up to which an approach continues, s: the longest gap of a module plus its latency.
pub const APPROACH_AGE: f32 = 1.3;
/// Age up to which it then waits for the position, s. A tag is covered for 0.25 s at a time in the mean (assumed), so
/// that one gap in 180 lasts longer than 1.3 s, one in 160,000 longer than this; and a second is left to the pilot until
/// the height is lost.
pub const WAITING_AGE: f32 = 3.0;
/// Age up to which dead reckoning holds the height, s: some decimetres off. Then the pilot has the throttle.
pub const HEIGHT_AGE: f32 = 4.0;
/// The same with barometric height, s: within [`LOST_AGE`].
pub const PRESSURE_AGE: f32 = 9.0;
/// Age of the newest fix at which the estimate ends, s: dead reckoning is metres off by then.
pub const LOST_AGE: f32 = 10.0;
/// Gap in the poses after which an outlier is not a jump, s: dead reckoning may be as far off.
pub const UNKNOWN_AGE: f32 = 1.0;
/// Age forced on the last fix of an inconsistent source, µs: just above [`APPROACH_AGE`], so that no mode dead-reckons
/// on it (see [`crate::mode::Mode::Hold`]).
pub const DEAD_RECKONING_INVALID_AGE: u64 = 1_310_000;
