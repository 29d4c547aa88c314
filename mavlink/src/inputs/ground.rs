//! Optical flow and range that another computer, or a module over MAVLink, measures below the vehicle.

use sophie_control::ground::{Flow, Range};

use super::Refusal;
use crate::dialect::{DISTANCE_SENSOR_DATA, OPTICAL_FLOW_RAD_DATA};

/// MAV_SENSOR_ORIENTATION: along the body's down axis.
const DOWN: u8 = 25;
/// DISTANCE_SENSOR's quality of a signal that is not valid.
const INVALID: u8 = 1;
/// Reach of a range that comes with a flow, which does not say it, m.
const REACH: (f32, f32) = (0.02, 40.0);
/// Oldest range that a flow brings along, µs.
const RANGE_AGE_MAX: u32 = 500_000;

/// What OPTICAL_FLOW_RAD says, in the body's axes, the end of its interval at `at` µs: the flow, and the range where it has one.
///
/// # Errors
/// Values that are no numbers or cannot be.
pub fn flow(m: &OPTICAL_FLOW_RAD_DATA, at: u64) -> Result<(Flow, Option<Range>), Refusal> {
    let flow = Flow {
        until_us: at,
        seconds: m.integration_time_us as f32 * 1e-6,
        angle: [m.integrated_x, m.integrated_y],
        quality: m.quality,
    };
    let known = m.distance >= 0.0 && m.time_delta_distance_us <= RANGE_AGE_MAX;
    let range = Range {
        at_us: at.saturating_sub(u64::from(m.time_delta_distance_us)),
        distance: Some(m.distance),
        reach: REACH,
    };
    let range = if known { range.checked() } else { None };
    flow.checked().map(|flow| (flow, range)).ok_or(Refusal::Value)
}

/// What DISTANCE_SENSOR says, measured at `at` µs.
///
/// # Errors
/// A sensor that does not look down, a reach that cannot be.
pub fn range(m: &DISTANCE_SENSOR_DATA, at: u64) -> Result<Range, Refusal> {
    if m.orientation != DOWN {
        return Err(Refusal::Frame);
    }
    let metres = |cm: u16| f32::from(cm) / 100.0;
    let (near, far) = (metres(m.min_distance), metres(m.max_distance));
    // At its farthest, and with a signal that it says is not valid, such a sensor sees nothing.
    let seen = m.signal_quality != INVALID && m.current_distance < m.max_distance;
    let range = Range {
        at_us: at,
        distance: seen.then_some(metres(m.current_distance)),
        reach: (near, far),
    };
    range.checked().ok_or(Refusal::Value)
}
