//! Least thrust of a rotor that turns.

use super::motor_pulses::least_command;
use super::thrust_curve::ThrustCurve;
use crate::params::Params;

/// Voltage ratio of a full battery: 4.2 V over 3.7 V a cell.
pub(super) const FULL_RATIO: f32 = 4.2 / 3.7;

/// Least thrust of a rotor that turns, N: `thrust_idle`, or at a full battery that of the least command where it is more.
#[inline(never)]
pub fn least_thrust(p: &Params) -> f32 {
    let least = ThrustCurve::from_params(p).thrust(least_command(p), FULL_RATIO);
    p.thrust_idle.max(least)
}
