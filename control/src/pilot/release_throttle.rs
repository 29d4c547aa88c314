//! Throttle at which the arms open on the pipe.

use crate::params::Params;

/// Least throttle at which the arms open, to carry some weight when they let go; held while they open or close again.
pub const RELEASE_THROTTLE_MIN: f32 = 0.2;

/// Least collective at which the arms open, N.
pub fn release_thrust(p: &Params) -> f32 {
    4.0 * p.thrust_max * RELEASE_THROTTLE_MIN
}
