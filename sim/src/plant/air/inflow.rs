//! Thrust of a rotor in air that moves along its axis: C_T(J) of an APC Slow Flyer 10x4.7 (UIUC propeller data, 6,500 rpm),
//! 0.1185 at rest, 0.0698 at J 0.378, 0.0176 at 0.599, J = V / (n D). Between them a line; below J = 0 the first line goes
//! on, since a rotor that sinks slowly meets its blades' angle of attack grown by as much.
//!
//! In hover (86 Hz, 0.254 m) that is 0.22 N per m/s and rotor: climbing, sinking and rolling are damped.

use core::f64::consts::TAU;

use super::super::propeller::RADIUS;

/// Advance ratio and thrust coefficient over that at rest.
const TABLE: [(f64, f64); 3] = [(0.0, 1.0), (0.378, 0.0698 / 0.1185), (0.599, 0.0176 / 0.1185)];
/// Advance ratio below which a rotor meets its own wake, and the table ends.
const LEAST: f64 = -0.2;
/// Speed below which a rotor gives too little for the ratio to matter, rad/s.
const SLOW: f64 = 30.0;

/// Factor on the static thrust of a rotor that turns at `speed` (rad/s) and advances along its thrust at `climb` m/s
/// against the air. At least 0: a propeller of fixed pitch brakes less than it pulls.
#[must_use]
pub fn factor(climb: f64, speed: f64) -> f64 {
    let advance = (climb * TAU / (speed.max(SLOW) * 2.0 * RADIUS)).max(LEAST);
    let [start, middle, end] = TABLE;
    let (low, high) = if advance < middle.0 {
        (start, middle)
    } else {
        (middle, end)
    };
    let slope = (high.1 - low.1) / (high.0 - low.0);
    (low.1 + slope * (advance - low.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Speed (rad/s) at 6,513 rpm, and the climb (m/s) at an advance ratio.
    fn climb(advance: f64) -> (f64, f64) {
        let turns = 6513.0 / 60.0;
        (advance * turns * 0.254, turns * TAU)
    }

    #[test]
    fn the_published_points_come_out() {
        for (advance, coefficient) in [(0.0, 0.1185), (0.378, 0.0698), (0.599, 0.0176)] {
            let (climb, speed) = climb(advance);
            assert!(
                (0.1185 * factor(climb, speed) - coefficient).abs() < 1e-4,
                "J {advance}"
            );
        }
        let (fast, speed) = climb(2.0);
        assert_eq!(factor(fast, speed), 0.0);
    }

    /// 1.225 · 86² · 0.254⁴ · 0.1185 N static; 0.22 N less per m/s.
    #[test]
    fn hover_is_damped_both_ways() {
        let squared: f64 = 0.254 * 0.254;
        let (static_thrust, speed) = (1.225 * 86.0 * 86.0 * squared * squared * 0.1185, 86.0 * TAU);
        for climb in [0.5, -0.5] {
            let change = static_thrust * (factor(climb, speed) - 1.0) / climb;
            assert!((change + 0.222).abs() < 0.003, "{change}");
        }
        assert_eq!(factor(0.0, speed), 1.0);
        assert_eq!(factor(0.0, 0.0), 1.0);
    }
}
