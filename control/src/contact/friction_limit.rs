//! Friction limit on a pipe: the lean up to which friction holds a vehicle that rests on it with both belly pads.
//!
//! Beside the crown the body turns about the pipe's axis. The pads lie at ±w, and the centre of mass h above them,
//! H = sqrt(R² - w²) + h above the axis. The rotors carry the share s of the weight, normal to the pads. With
//! cos ψ = sqrt(1 - w²/R²) and friction μ, the vehicle sticks while
//!
//!   sin θ · K <= cos θ - s,   K = H cos ψ / (μ R) + μ (H cos ψ / R - 1)
//!
//! so more thrust holds less: at μ 0.6 on 0.3 m up to 25° without thrust, 16° at a share of 0.375, 11° at 0.56.
//!
//! A level push F at the centre of mass turns the force that friction must hold by δ, tan δ = F / (m g): without thrust a
//! lean θ is held against it while θ + δ is. Arms that press add a seventh to the normal forces, and so to μ.

use crate::maths::scalar::{GRAVITY, atan2, clamp, cos, sin, sqrt};
use crate::params::Params;

/// Distance of a belly pad from the middle, m (assumed).
const PAD: f32 = 0.03;
/// Centre of mass above the pads, m (assumed).
const HEIGHT: f32 = 0.04;
/// Push that a grip must hold, N: a wind of 10 m/s on 0.05 m² of drag area.
const PUSH: f32 = 3.0;
/// Normal forces under arms that press with the grip pressure over those without (estimated, docs/design/contact.md).
const PRESSED: f32 = 1.15;

/// Friction limit on the pipe that the parameters describe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionLimit {
    /// K of the formula above.
    slope: f32,
    /// K under arms that press.
    pressed: f32,
    /// δ of the formula above, rad.
    push: f32,
}

impl FrictionLimit {
    /// From friction and diameter.
    pub fn from_params(p: &Params) -> Self {
        let radius = clamp(0.5 * p.pipe_diameter, 1.5 * PAD, 10.0);
        let friction = clamp(p.pipe_friction, 0.05, 2.0);
        let flat = sqrt(radius * radius - PAD * PAD);
        let lever = (flat + HEIGHT) * flat / (radius * radius);
        let slope = |friction: f32| lever / friction + friction * (lever - 1.0);
        Self {
            slope: slope(friction),
            pressed: slope(PRESSED * friction),
            push: atan2(PUSH, p.mass * GRAVITY),
        }
    }

    /// Friction holds a lean of `lean` rad, either side, while the rotors carry the `share` of the weight.
    pub fn holds(self, lean: f32, share: f32) -> bool {
        let lean = clamp(lean.abs(), 0.0, 1.5);
        sin(lean) * self.slope <= cos(lean) - share
    }

    /// Pressing arms and friction hold a lean of `lean` rad without rotors against a push of 3 N from the worse side.
    pub fn holds_pushed(self, lean: f32) -> bool {
        let lean = clamp(lean.abs() + self.push, 0.0, 1.5);
        sin(lean) * self.pressed <= cos(lean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::maths::scalar::deg;

    fn friction_limit(diameter: f32, friction: f32) -> FrictionLimit {
        FrictionLimit::from_params(&Params {
            pipe_diameter: diameter,
            pipe_friction: friction,
            ..Params::default()
        })
    }

    /// Largest lean that is held, °.
    fn largest(friction_limit: FrictionLimit, share: f32) -> f32 {
        let held = (0..900).take_while(|&i| friction_limit.holds(deg(0.1 * i as f32), share));
        0.1 * held.count() as f32 - 0.1
    }

    #[test]
    fn the_limits_are_those_of_the_balance_of_forces() {
        // Offsets of 78, 51 and 36 mm at μ 0.6 on 0.3 m, 44 at μ 0.3, 53 and 104 on 0.2 and 0.4 m, over H.
        for (diameter, friction, share, beside, lever) in [
            (0.3, 0.6, 0.0, 78.0, 187.0),
            (0.3, 0.6, 0.375, 51.0, 187.0),
            (0.3, 0.6, 0.563, 36.0, 187.0),
            (0.3, 0.3, 0.0, 44.0, 187.0),
            (0.2, 0.6, 0.0, 53.0, 135.4),
            (0.4, 0.6, 0.0, 104.0, 237.7),
        ] {
            let got = largest(friction_limit(diameter, friction), share);
            let wanted = (beside / lever as f32).asin().to_degrees();
            assert!(
                (got - wanted).abs() < 0.5,
                "{diameter} {friction} {share}: {got} for {wanted} deg"
            );
        }
    }

    /// tan δ = 3 / (1.8 g): 9.6°. At μ 0.69 on 0.3 m K is 1.92: 27.5° in all; at 0.345 3.62: 15.4°; at 0.23 5.35: 10.6°.
    #[test]
    fn a_push_leaves_less_lean_and_of_slippery_pipes_next_to_none() {
        for (friction, wanted) in [(0.6, 17.9), (0.3, 5.8), (0.2, 1.0)] {
            let limit = friction_limit(0.3, friction);
            let held = (0..900).take_while(|&i| limit.holds_pushed(deg(0.1 * i as f32)));
            let got = 0.1 * held.count() as f32 - 0.1;
            assert!((got - wanted).abs() < 0.3, "{friction}: {got} for {wanted} deg");
        }
        assert!(!friction_limit(0.3, 0.15).holds_pushed(0.0));
        assert!(!friction_limit(0.3, 0.6).holds_pushed(f32::INFINITY));
    }

    #[test]
    fn a_vehicle_that_hangs_on_its_rotors_is_held_by_nothing() {
        assert!(!friction_limit(0.3, 0.6).holds(0.0, 1.1));
        assert!(friction_limit(0.3, 0.6).holds(0.0, 0.9));
        assert!(!friction_limit(0.3, 0.6).holds(f32::INFINITY, 0.0));
    }

    #[test]
    fn parameters_at_their_ends_give_a_limit() {
        for (diameter, friction) in [(0.0, 0.0), (1e6, 1e6), (0.05, 0.1)] {
            let limit = largest(friction_limit(diameter, friction), 0.0);
            assert!((0.0..89.0).contains(&limit), "{limit}");
        }
    }
}
