//! Place of the pipe, by a companion computer.

use sophie_control::approach::pipe_target::PipeTarget;

use super::pose::{LOCAL_NED, POSITION_MAX};
use super::{Refusal, bounded, rotation};
use sophie_dialect::LANDING_TARGET_DATA;

/// Pipe of LANDING_TARGET: x, y, z of the crown at the perch, and q, whose x axis runs along the pipe. A q of zeros, or
/// with NaN first, gives no direction. The caller sets the time.
///
/// # Errors
/// Another frame than the poses', no position, a value that is not a number or out of bounds, or a pipe too steep to
/// sit on.
pub fn target(m: &LANDING_TARGET_DATA) -> Result<PipeTarget, Refusal> {
    if m.frame != LOCAL_NED {
        return Err(Refusal::Frame);
    }
    if m.position_valid != 1 {
        return Err(Refusal::Value);
    }
    let given = m.q.iter().any(|part| *part != 0.0);
    let along = if given { rotation(m.q)? } else { None };
    let target = PipeTarget {
        at_us: 0,
        crown_position: bounded([m.x, m.y, m.z], POSITION_MAX)?,
        heading: match along {
            Some(q) => Some(PipeTarget::heading_of(q).ok_or(Refusal::Value)?),
            None => None,
        },
    };
    Ok(target)
}
