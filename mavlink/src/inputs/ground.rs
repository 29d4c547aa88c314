//! Optical flow and range below the vehicle, from a companion computer or a module over MAVLink.

use sophie_control::navigation::flow_range_sample::{Flow, Range};

use super::Refusal;
use sophie_dialect::{DISTANCE_SENSOR_DATA, OPTICAL_FLOW_RAD_DATA};

/// MAV_SENSOR_ORIENTATION: along the body's down axis.
const DOWN: u8 = 25;
/// DISTANCE_SENSOR's signal quality of an invalid measurement.
const INVALID: u8 = 1;
/// Nearest and farthest distance, m, for a message without them: a range within a flow message, or a minimum of 0.
const REACH: (f32, f32) = (0.02, 40.0);
/// Oldest range in a flow message, µs.
const RANGE_AGE_MAX: u32 = 500_000;

/// Flow of OPTICAL_FLOW_RAD in the body's axes, and its range, if it has one, with the range's age at the end of the
/// flow's interval, µs. The caller sets the times.
///
/// # Errors
/// A value is not a number or impossible.
pub fn flow(m: &OPTICAL_FLOW_RAD_DATA) -> Result<(Flow, Option<(Range, u64)>), Refusal> {
    let flow = Flow {
        until_us: 0,
        seconds: m.integration_time_us as f32 * 1e-6,
        angle: [m.integrated_x, m.integrated_y],
        quality: m.quality,
    };
    let known = m.distance >= 0.0 && m.time_delta_distance_us <= RANGE_AGE_MAX;
    let range = Range {
        at_us: 0,
        distance: Some(m.distance),
        reach: REACH,
    };
    let range = if known { range.checked() } else { None };
    let range = range.map(|range| (range, m.time_delta_distance_us.into()));
    flow.checked().map(|flow| (flow, range)).ok_or(Refusal::Value)
}

/// Range of DISTANCE_SENSOR. The caller sets its time.
///
/// # Errors
/// A sensor that does not look down, or a reach that is impossible or has no maximum: without a maximum, "no return"
/// and "invalid" are the same.
pub fn range(m: &DISTANCE_SENSOR_DATA) -> Result<Range, Refusal> {
    if m.orientation != DOWN {
        return Err(Refusal::Frame);
    }
    if m.max_distance == 0 {
        return Err(Refusal::Value);
    }
    let metres = |cm: u16| f32::from(cm) / 100.0;
    // A minimum of 0 means "not given": no sensor measures from there on, and many send 0 without a return.
    let near = if m.min_distance == 0 {
        REACH.0
    } else {
        metres(m.min_distance)
    };
    // The maximum distance and an invalid signal both mean "no return".
    let seen = m.signal_quality != INVALID && m.current_distance < m.max_distance;
    let range = Range {
        at_us: 0,
        distance: seen.then_some(metres(m.current_distance)),
        reach: (near, metres(m.max_distance)),
    };
    range.checked().ok_or(Refusal::Value)
}
