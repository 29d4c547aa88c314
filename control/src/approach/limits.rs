//! Lengths, speeds and times of the approach.

/// Half the width of the first sweep, which each next one adds, and of the widest, m: the hold begins within a metre
/// of the pipe.
pub const SWEEP: f32 = 0.4;
pub const SWEEP_MAX: f32 = 1.3;
/// Speeds across and along the pipe, m/s: of the first sweep, and of the slower later phases.
pub const SWEEP_SPEED: f32 = 0.35;
pub const CROSS_SPEED: f32 = 0.25;
/// Distance beside the pipe at which a crossing turns back, m.
pub const BESIDE: f32 = 0.13;
/// Crossings from which the crown is computed, with the way out to the first.
pub const LEGS: u8 = 3;
/// Least difference between the crown and a later edge for which the approach gives up, m; and the deviations beyond which it
/// does.
pub const AGREE: f32 = 0.12;
pub const AGREE_DEVIATIONS: f32 = 3.0;
/// Deviation of an edge's place, m, and of a place by flow, m/√s.
pub const EDGE: f32 = 0.025;
pub const DRIFT: f32 = 0.04;
/// Distance from the crown, in half widths of the pipe, beyond which an edge is one of its sides.
pub const ASIDE: f32 = 0.5;
/// Ratio of the beam's ways along the pipe and across it beyond which it passes an edge lengthwise.
pub const AHEAD: f32 = 2.0;
/// Time without the pipe at the end of the pass along it after which the pipe has ended, s: until then a gust lets the
/// beam return.
pub const END_TIME: f32 = 1.5;
/// Accepted widths of a crossing, share of the pipe's diameter: of a pipe of 0.2 m where 0.3 m is set, half of which passes unseen in a
/// gust, to one that a gust lets the beam follow.
pub const WIDTH: (f32, f32) = (0.3, 1.6);
/// Change of a level that the vehicle has crossed after which the range is inconsistent, m: the smallest pipe's diameter.
pub const MISFIT: f32 = 0.2;
/// Age of the height beyond which the vehicle rises, s: a vertical speed that is off by 0.1 m/s costs a quarter of [`LOW`].
pub const LOST_TIME: f32 = 1.0;
/// Heights over the crown, m: at the start of another attempt, and of the crossings.
pub const HIGH: f32 = 0.6;
pub const LOW: f32 = 0.4;
/// Climb after a range that is inconsistent, m: with a scale of 1.6 it is still [`HIGH`].
pub const CLEAR: f32 = 1.0;
/// Height over the ground to which it climbs at most, m: flow is used up to 2.5 m.
pub const CEILING: f32 = 2.3;
/// Climb without a known crown, m.
pub const RISE: f32 = 0.4;
/// Largest speed of a climb between attempts, and of the descent, m/s.
pub const CLIMB_SPEED: f32 = 0.35;
pub const DESCENT: f32 = 0.2;
/// Length searched along the pipe each way, and least distance of the landing point from an end, m: the arms reach 0.2
/// m.
pub const LOOK: f32 = 0.3;
pub const END: f32 = 0.3;
/// Speed at which the vehicle follows a corrected crown, m/s.
pub const CORRECT_SPEED: f32 = 0.05;
/// Range below which the descent pauses while the vehicle is off the crown by more than the second figure, m.
pub const NEAR: f32 = 0.25;
pub const NEAR_OFF: f32 = 0.06;
/// Range at which the vehicle waits to be over the crown, m: the least at which flow works with some margin.
pub const GATE: f32 = 0.10;
/// Speed back up to the gate, m/s, and the time in which a descent stops, s: half of [`DESCENT`] over the slew limit
/// of the command.
pub const BACK_SPEED: f32 = 0.15;
pub const STOP_TIME: f32 = 0.15;
/// Age of the newest flow or pose beyond which the descent does not pass the gate, s, and the range at which the
/// vehicle then waits for flow, m: a touch within [`LAST_TIME`] is still below the age that ends an approach.
pub const BLIND: f32 = 0.3;
pub const SEEING: f32 = 0.16;
/// Speed of the final descent, m/s, and its time to the touch, s: each tenth of a second costs half a centimetre in
/// gusts.
pub const LAST_SPEED: f32 = 0.3;
pub const LAST_TIME: f32 = 0.45;
/// Time constant over which the change of the speed across is measured, s.
pub const SLOW_TIME: f32 = 0.15;
/// Criteria of the gate: offset at first and after [`PATIENCE`], m, speed across, m/s, and the time for which they
/// hold, s.
pub const STRICT: f32 = 0.015;
pub const CONTENT: f32 = 0.025;
pub const GATE_SPEED: f32 = 0.04;
pub const GATE_TIME: f32 = 0.05;
pub const PATIENCE: f32 = 10.0;
/// Offset in the final descent beyond which the vehicle climbs again, m: the tolerance of the pads (docs/results.md).
pub const ASTRAY: f32 = 0.05;
/// Timeouts, s: all sweeps (8 m of way), one way, centring over the crown, the gate, the touch.
pub const SEARCH_TIME: f32 = 60.0;
pub const WAY_TIME: f32 = 15.0;
pub const CENTRE_TIME: f32 = 12.0;
pub const GATE_WAIT: f32 = 15.0;
pub const TOUCH_WAIT: f32 = 2.5;
/// Age beyond which a range is stale, s.
pub const RANGE_AGE: f32 = 0.3;
/// Slew limit of the horizontal velocity command, m/s²: the hold follows faster turns with twice the speed.
pub const SLEW: f32 = 0.3;
/// Height error to vertical speed, 1/s.
pub const HEIGHT_GAIN: f32 = 1.5;
/// Distances at which a place counts as reached, m.
pub const REACHED: f32 = 0.02;
pub const OVER: f32 = 0.08;
/// Least time on the way there, s: a place that the vehicle only passes is not reached.
pub const OVER_TIME: f32 = 0.5;
/// Heading error to yaw rate, 1/s, and its limit, rad/s.
pub const HEADING_GAIN: f32 = 1.0;
pub const YAW_RATE_MAX: f32 = 0.3;
/// Largest horizontal distance of a reported pipe from the vehicle, m: the hold begins within a metre of it.
pub const TARGET_REACH: f32 = 1.5;
/// The same for another attempt, and the bounds of the pipe's depth below the vehicle, m. Arms that open at a lean throw the
/// vehicle off with up to 3 m/s within 1.7 m, and the hold brakes with 3 m/s² after 0.4 s: 4.4 m off.
pub const TARGET_RETURN: f32 = 6.0;
pub const TARGET_BELOW: (f32, f32) = (0.0, 1.5);
/// Change of the reported place that is a jump, m, and the time constant of its smoothing, s.
pub const TARGET_STEP: f32 = 0.12;
pub const TARGET_TIME: f32 = 0.3;
/// Distance from the vehicle's centre down to the point from which a range would be measured, m, and how much lower
/// than with a range the vehicle waits to be over the crown: poses are good to the touch, 4 cm further down.
pub const UNDER: f32 = 0.02;
pub const LOWER: f32 = 0.05;
/// Heading error below which the vehicle is along the pipe, rad.
pub const ALONG: f32 = 0.09;
