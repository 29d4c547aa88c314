//! Lengths, speeds and times of the way onto the pipe.

/// Half the width of the first sweep, by how much each next one is wider, and the widest, m: the hold begins within a metre of
/// the pipe.
pub const SWEEP: f32 = 0.4;
pub const SWEEP_MAX: f32 = 1.3;
/// Speeds across and along the pipe, m/s: first sweep, and the slower rest.
pub const SWEEP_SPEED: f32 = 0.35;
pub const CROSS_SPEED: f32 = 0.25;
/// Way beside the pipe at which a crossing turns back, m.
pub const BESIDE: f32 = 0.13;
/// Crossings that the crown is taken from, with the way out to the first.
pub const LEGS: u8 = 3;
/// Farthest that two crossings, or the last one and the edge on the way back, may differ, m; and the weight of the newer.
pub const AGREE: f32 = 0.12;
pub const NEWER: f32 = 0.7;
/// Time without the pipe at the end of the way along it after which it has ended, s: a gust has let the beam come back.
pub const END_TIME: f32 = 1.5;
/// Widths of a crossing that are the pipe's, share of its diameter.
pub const WIDTH: (f32, f32) = (0.7, 1.35);
/// Highest step at an edge, beside half the width of the pipe, and the lowest that the beam falls, share of those by which the
/// pipe was crossed first: ground is not even, and a beam falls off a flank. One that becomes 1.6 times too long shows a third
/// surface below the crown, then steps of 1.6 times.
pub const HIGHER: f32 = 1.25;
pub const LOWEST: f32 = 0.5;
/// Time for which such a step lasts, s: a range that jumps is back before, and has a name of its own.
pub const LASTING: f32 = 0.35;
/// Heights over the crown, m: to which it climbs for another try, and of the crossings.
pub const HIGH: f32 = 0.6;
pub const LOW: f32 = 0.4;
/// Climb from where the range does not fit the motion, m: of a scale of 1.6 it is still [`HIGH`].
pub const CLEAR: f32 = 1.0;
/// Climb where no crown is known, m.
pub const RISE: f32 = 0.4;
/// Fastest climb between tries, and fastest way down, m/s.
pub const CLIMB_SPEED: f32 = 0.35;
pub const DESCENT: f32 = 0.2;
/// How far it looks along the pipe each way, and how near to an end it sits down, m: the arms reach 0.2 m.
pub const LOOK: f32 = 0.3;
pub const END: f32 = 0.3;
/// Speed at which it follows a corrected crown, m/s.
pub const CORRECT_SPEED: f32 = 0.05;
/// Range below which it does not sink while it is this far off, m.
pub const NEAR: f32 = 0.25;
pub const NEAR_OFF: f32 = 0.06;
/// Range below which, over the crown, the flank is not met, m.
pub const STEADY: f32 = 0.3;
/// Range at which it waits to be over the crown, m: the last at which flow is seen with some margin.
pub const GATE: f32 = 0.10;
/// Speed back up to it, m/s, and the time in which a sinking is ended, s: half of [`DESCENT`] over the change of a wish.
pub const BACK_SPEED: f32 = 0.15;
pub const STOP_TIME: f32 = 0.15;
/// Age of the newest flow or pose beyond which it does not sink on from there, s, and the range at which it waits for flow then,
/// m: a touch within [`LAST_TIME`] is still short of what ends an approach.
pub const BLIND: f32 = 0.3;
pub const SEEING: f32 = 0.16;
/// Speed of the last bit, m/s, and time from there to the touch, s: each tenth of a second costs half a centimetre in gusts.
pub const LAST_SPEED: f32 = 0.3;
pub const LAST_TIME: f32 = 0.45;
/// Time over which the change of the speed across is taken, s.
pub const SLOW_TIME: f32 = 0.15;
/// Offset that goes on from there, at once and after [`PATIENCE`], m, the speed across, m/s, and for how long, s.
pub const STRICT: f32 = 0.015;
pub const CONTENT: f32 = 0.025;
pub const GATE_SPEED: f32 = 0.04;
pub const GATE_TIME: f32 = 0.05;
pub const PATIENCE: f32 = 10.0;
/// Offset on the last bit beyond which it goes up again, m: what the pads hold (docs/results.md).
pub const ASTRAY: f32 = 0.05;
/// Longest of what is waited for, s: all sweeps (8 m of way), a way, the crown under it, the gate, the touch.
pub const SEARCH_TIME: f32 = 60.0;
pub const WAY_TIME: f32 = 15.0;
pub const CENTRE_TIME: f32 = 12.0;
pub const GATE_WAIT: f32 = 15.0;
pub const TOUCH_WAIT: f32 = 2.5;
/// Height over the ground of the take-off from which on what is below may be a pipe, m.
pub const RAISED: f32 = 0.3;
/// Age of a range beyond which it is none, s.
pub const RANGE_AGE: f32 = 0.3;
/// Change of the level speed asked for, m/s²: the hold follows what turns faster with twice the speed.
pub const SLEW: f32 = 0.3;
/// Height error to vertical speed, 1/s.
pub const HEIGHT_GAIN: f32 = 1.5;
/// Distances at which a place is reached, m.
pub const REACHED: f32 = 0.02;
pub const OVER: f32 = 0.08;
/// Least time that the way there is given, s: it is not just passed.
pub const OVER_TIME: f32 = 0.5;
/// Heading error to yaw rate, 1/s, and its limit, rad/s.
pub const HEADING_GAIN: f32 = 1.0;
pub const YAW_RATE_MAX: f32 = 0.3;
/// Farthest that a place of the pipe may be level, and below the vehicle, m: the hold begins within a metre of it.
pub const TARGET_REACH: f32 = 1.5;
/// The same where it comes back: an escape has thrown it two metres off the pipe.
pub const TARGET_RETURN: f32 = 3.0;
pub const TARGET_BELOW: (f32, f32) = (0.0, 1.5);
/// Change of that place that is a jump, m, and the time over which its noise is smoothed, s.
pub const TARGET_STEP: f32 = 0.12;
pub const TARGET_TIME: f32 = 0.3;
/// From the vehicle's centre down to where a range would be measured, m, and by how much lower than with one it waits to be
/// over the crown: poses are good to the touch, 4 cm further down.
pub const UNDER: f32 = 0.02;
pub const LOWER: f32 = 0.05;
/// Heading error at which it is along the pipe, rad.
pub const ALONG: f32 = 0.09;
