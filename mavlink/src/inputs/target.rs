//! Where another computer sees the pipe.

use sophie_control::approach::pipe_target::PipeTarget;

use super::pose::{LOCAL_NED, POSITION_MAX};
use super::{Refusal, bounded, rotation};
use sophie_dialect::LANDING_TARGET_DATA;

/// What LANDING_TARGET says: x, y, z of the crown where the vehicle is to sit, and q, whose x axis runs along the pipe. All
/// zeros, or NaN in the first, is a direction that is not given. Its time is the caller's to set.
///
/// # Errors
/// Axes other than the poses' own, no position, values that are no numbers or out of bounds, a pipe too steep to sit on.
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
        crown: bounded([m.x, m.y, m.z], POSITION_MAX)?,
        heading: match along {
            Some(q) => Some(PipeTarget::heading_of(q).ok_or(Refusal::Value)?),
            None => None,
        },
    };
    Ok(target)
}
