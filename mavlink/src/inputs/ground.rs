//! Optical flow and range that another computer, or a module over MAVLink, measures below the vehicle.

use sophie_control::navigation::flow_range_sample::{Flow, Range};

use super::Refusal;
use sophie_dialect::{DISTANCE_SENSOR_DATA, OPTICAL_FLOW_RAD_DATA};

/// MAV_SENSOR_ORIENTATION: along the body's down axis.
const DOWN: u8 = 25;
/// DISTANCE_SENSOR's quality of a signal that is not valid.
const INVALID: u8 = 1;
/// Reach of a range whose message does not say it, m: what comes with a flow, and a nearest distance of 0.
const REACH: (f32, f32) = (0.02, 40.0);
/// Oldest range that a flow brings along, µs.
const RANGE_AGE_MAX: u32 = 500_000;

/// What OPTICAL_FLOW_RAD says, in the body's axes: the flow, and the range where it has one, with its age at the end of the
/// flow's interval, µs. Their times are the caller's to set.
///
/// # Errors
/// Values that are no numbers or cannot be.
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

/// What DISTANCE_SENSOR says; its time is the caller's to set.
///
/// # Errors
/// A sensor that does not look down, a reach that cannot be or whose end is not given: nothing within it could not be known.
pub fn range(m: &DISTANCE_SENSOR_DATA) -> Result<Range, Refusal> {
    if m.orientation != DOWN {
        return Err(Refusal::Frame);
    }
    if m.max_distance == 0 {
        return Err(Refusal::Value);
    }
    let metres = |cm: u16| f32::from(cm) / 100.0;
    // 0 is not given: no sensor measures from there on, and many say 0 where they see nothing.
    let near = if m.min_distance == 0 {
        REACH.0
    } else {
        metres(m.min_distance)
    };
    // At its farthest, and with a signal that it says is not valid, such a sensor sees nothing.
    let seen = m.signal_quality != INVALID && m.current_distance < m.max_distance;
    let range = Range {
        at_us: 0,
        distance: seen.then_some(metres(m.current_distance)),
        reach: (near, metres(m.max_distance)),
    };
    range.checked().ok_or(Refusal::Value)
}
