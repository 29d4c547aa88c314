//! What four tilted rotors do to the body, and how that changes with their thrusts.
//!
//! A rotor at (±b, ∓d) whose arm is tilted by α leans its thrust inward by α. Hinged at the centre line,
//! the thrust stays perpendicular to the arm, so its roll lever is d whatever the tilt; its pitch lever
//! acts on T cos α; its yaw moment is the sideways part T sin α at ±b and the rotor's drag ±k_q T.

use crate::deflection::ArmModel;
use crate::math;
use crate::params::Params;
use crate::wrench::{Configuration, FORE, PerArm, SIDE, Wrench, YAW};

/// Where the rotors are and how they turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Sideways lever d, m.
    pub d: f32,
    /// Fore-aft lever b, m.
    pub b: f32,
    /// Signed drag ratio χ k_q, m: positive for configuration B.
    pub drag: f32,
}

impl Geometry {
    /// The geometry that the parameters describe.
    pub fn from_params(p: &Params, configuration: Configuration) -> Self {
        Self {
            d: p.arm_d,
            b: p.arm_b,
            drag: configuration.chi() * p.torque_ratio,
        }
    }

    /// The wrench of the thrusts (N) of rotors tilted by `tilt` (rad).
    pub fn wrench(&self, thrusts: &PerArm<f32>, tilt: &PerArm<f32>) -> Wrench {
        let mut w = Wrench::default();
        for ((t, a), (side, (fore, yaw))) in thrusts
            .iter()
            .zip(tilt)
            .zip(SIDE.iter().zip(FORE.iter().zip(&YAW)))
        {
            let lift = t * math::cos(*a);
            w.thrust += lift;
            w.roll += side * self.d * t;
            w.pitch += fore * self.b * lift;
            w.yaw += yaw * t * (self.b * math::sin(*a) + self.drag);
        }
        w
    }
}

/// Rows of the effectiveness that depend on the tilt; roll is ±d always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effectiveness {
    /// d(lift)/dT of each rotor, 1; times ±b it is the pitch entry.
    pub lift: PerArm<f32>,
    /// |d(yaw)/dT| with the sign of the authority, m; the entry is this times the rotor's yaw sign.
    pub yaw: PerArm<f32>,
}

impl Effectiveness {
    /// At the frozen tilt: what a change of thrust does before the arm has moved.
    pub fn frozen(geometry: &Geometry, tilt: &PerArm<f32>) -> Self {
        Self {
            lift: tilt.map(math::cos),
            yaw: tilt.map(|a| geometry.b * math::sin(a) + geometry.drag),
        }
    }

    /// Quasi-static: what a change of thrust does once the arm has followed, with T dα/dT in it.
    pub fn quasi_static(
        geometry: &Geometry,
        model: &ArmModel,
        thrusts: &PerArm<f32>,
        tilt: &PerArm<f32>,
    ) -> Self {
        let mut e = Self {
            lift: [1.0; 4],
            yaw: [geometry.drag; 4],
        };
        for ((lift, yaw), (t, a)) in e.lift.iter_mut().zip(&mut e.yaw).zip(thrusts.iter().zip(tilt)) {
            let (s, c) = (math::sin(*a), math::cos(*a));
            let follow = t * model.slope(*t);
            *lift = c - s * follow;
            *yaw = geometry.b * (s + c * follow) + geometry.drag;
        }
        e
    }
}

/// The inverse of an effectiveness in closed form.
///
/// The lift row and the pitch row share their entries, so the front pair's and the rear pair's lift are
/// known at once; what is left is a 2×2 system for how each pair splits it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inverse {
    geometry: Geometry,
    e: Effectiveness,
    inv_lift_3: f32,
    inv_lift_4: f32,
    ratio_front: f32,
    ratio_rear: f32,
    yaw_front: f32,
    yaw_rear: f32,
    inv_determinant: f32,
}

impl Inverse {
    /// The inverse, or `None` where the effectiveness has none.
    pub fn new(geometry: Geometry, e: Effectiveness) -> Option<Self> {
        /// Least determinant, m: a hundredth of the stiff frame's yaw authority.
        const LEAST: f32 = 1.6e-4;
        let [l1, l2, l3, l4] = e.lift;
        let [y1, y2, y3, y4] = e.yaw;
        let (inv_lift_3, inv_lift_4) = (1.0 / l3, 1.0 / l4);
        let (ratio_front, ratio_rear) = (l1 * inv_lift_3, l2 * inv_lift_4);
        let (yaw_front, yaw_rear) = (y1 + y3 * ratio_front, y2 + y4 * ratio_rear);
        let determinant = (1.0 + ratio_front) * yaw_rear + (1.0 + ratio_rear) * yaw_front;
        let usable = !(-LEAST..=LEAST).contains(&determinant);
        (usable && inv_lift_3.is_finite() && inv_lift_4.is_finite()).then(|| Self {
            geometry,
            e,
            inv_lift_3,
            inv_lift_4,
            ratio_front,
            ratio_rear,
            yaw_front,
            yaw_rear,
            inv_determinant: 1.0 / determinant,
        })
    }

    /// The thrusts (N) whose effect is the wrench `w`.
    pub fn solve(&self, w: Wrench) -> PerArm<f32> {
        let [l1, l2, _, _] = self.e.lift;
        let [_, _, y3, y4] = self.e.yaw;
        let pitch = w.pitch / self.geometry.b;
        // Lift of the front pair and of the rear pair, carried by rotors 3 and 4 to begin with.
        let (front, rear) = (0.5 * (w.thrust + pitch), 0.5 * (w.thrust - pitch));
        let (f3, r4) = (front * self.inv_lift_3, rear * self.inv_lift_4);
        // Roll and yaw that rotors 1 and 2 must add by taking over from 3 and 4.
        let roll = w.roll / self.geometry.d + f3 + r4;
        let yaw = w.yaw + y3 * f3 - y4 * r4;
        let t1 = (roll * self.yaw_rear + yaw * (1.0 + self.ratio_rear)) * self.inv_determinant;
        let t2 = (roll * self.yaw_front - yaw * (1.0 + self.ratio_front)) * self.inv_determinant;
        [
            t1,
            t2,
            (front - l1 * t1) * self.inv_lift_3,
            (rear - l2 * t2) * self.inv_lift_4,
        ]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn geometry() -> Geometry {
        Geometry {
            d: 0.178,
            b: 0.178,
            drag: 0.016,
        }
    }

    #[test]
    fn the_wrench_agrees_with_cross_products() {
        let g = geometry();
        let (thrusts, tilt) = ([3.0f32, 4.0, 5.0, 6.0], [0.1f32, -0.2, 0.3, 0.05]);
        let w = g.wrench(&thrusts, &tilt);
        let (mut force, mut moment) = ([0.0f32; 3], [0.0f32; 3]);
        for i in 0..4 {
            let (t, a) = (
                thrusts.get(i).copied().unwrap_or(0.0),
                tilt.get(i).copied().unwrap_or(0.0),
            );
            let (fore, left) = (
                if i % 2 == 0 { 1.0 } else { -1.0 },
                if i < 2 { 1.0 } else { -1.0 },
            );
            // Arm hinged at the centre line: its tip, and the thrust perpendicular to it.
            let r = crate::vector::Vec3::new(fore * g.b, -left * g.d * a.cos(), -g.d * a.sin());
            let f = crate::vector::Vec3::new(0.0, left * t * a.sin(), -t * a.cos());
            let m = r.cross(f);
            // Rotors 1 and 4 turn counter-clockwise from above, so their drag turns the body clockwise.
            let spin = if i == 0 || i == 3 { 1.0 } else { -1.0 };
            for (sum, x) in force.iter_mut().zip(f.to_array()) {
                *sum += x;
            }
            for (sum, x) in moment.iter_mut().zip([m.x, m.y, m.z + spin * g.drag * t]) {
                *sum += x;
            }
        }
        let expected = [-force[2], moment[0], moment[1], moment[2]];
        for (got, want) in [w.thrust, w.roll, w.pitch, w.yaw].into_iter().zip(expected) {
            assert!((got - want).abs() < 0.02, "{got} {want}");
        }
    }

    #[test]
    fn the_frozen_authority_reverses_where_the_note_says() {
        // asin(k_q/b) = 5.157° of droop: 3.1 N at the default; quasi-static only at 1.5 N.
        let (g, m) = (geometry(), ArmModel::new(6.9, 7.75, 4.15));
        let frozen = |t: f32| Effectiveness::frozen(&g, &[m.angle(t); 4]).yaw[0];
        let quasi = |t: f32| Effectiveness::quasi_static(&g, &m, &[t; 4], &[m.angle(t); 4]).yaw[0];
        assert!(frozen(3.0) < 0.0 && frozen(3.25) > 0.0);
        assert!(quasi(1.35) < 0.0 && quasi(1.6) > 0.0);
        // At 30 % throttle about +2.2 k_q.
        assert!((quasi(2.49) / 0.016 - 2.2).abs() < 0.25);
    }

    #[test]
    fn the_quasi_static_rows_are_derivatives_of_the_wrench() {
        let (g, m) = (geometry(), ArmModel::new(6.9, 7.75, 4.15));
        let at = |t: f32| g.wrench(&[t; 4], &[m.angle(t); 4]);
        let t = 5.0f32;
        let e = Effectiveness::quasi_static(&g, &m, &[t; 4], &[m.angle(t); 4]);
        let slope = (at(t + 0.2).thrust - at(t - 0.2).thrust) / 0.4 / 4.0;
        assert!((slope - e.lift[0]).abs() < 0.01, "{slope} {}", e.lift[0]);
        let one = |t: f32| {
            let thrusts = [t, 5.0, 5.0, 5.0];
            g.wrench(&thrusts, &thrusts.map(|t| m.angle(t))).yaw
        };
        let slope = (one(t + 0.2) - one(t - 0.2)) / 0.4;
        assert!((slope - e.yaw[0]).abs() < 0.002, "{slope} {}", e.yaw[0]);
    }

    proptest! {
        #[test]
        fn allocation_then_effectiveness_gives_back_the_wrench(
            lift in prop::array::uniform4(0.7f32..1.0),
            yaw in prop::array::uniform4(0.005f32..0.08),
            thrust in -10.0f32..30.0, roll in -2.0f32..2.0, pitch in -2.0f32..2.0, turn in -0.2f32..0.2,
            side in prop::bool::ANY,
        ) {
            let sign = if side { 1.0 } else { -1.0 };
            let e = Effectiveness { lift, yaw: yaw.map(|y| y * sign) };
            let g = geometry();
            let t = Inverse::new(g, e).expect("regular").solve(Wrench { thrust, roll, pitch, yaw: turn });
            let mut w = Wrench::default();
            for i in 0..4 {
                w.thrust += e.lift[i] * t[i];
                w.roll += SIDE[i] * g.d * t[i];
                w.pitch += FORE[i] * g.b * e.lift[i] * t[i];
                w.yaw += YAW[i] * e.yaw[i] * t[i];
            }
            prop_assert!((w.thrust - thrust).abs() < 2e-3);
            prop_assert!((w.roll - roll).abs() < 1e-3 && (w.pitch - pitch).abs() < 1e-3);
            prop_assert!((w.yaw - turn).abs() < 1e-3);
        }
    }
}
