//! Effect of four tilted rotors on the body, and its change with their thrusts.
//!
//! Evaluated at 1 kHz; body axes FRD, thrusts in N, tilts in rad with the tip up.
//!
//! A rotor at (±b, ∓d) tilted by α leans its thrust inward by α, perpendicular to the arm hinged at the centre line:
//! the roll lever is d at any tilt, the pitch lever acts on T cos α, and the yaw moment is the sideways part T sin α at
//! ±b plus the rotor's drag ±k_q T.

use crate::allocation::wrench::{Configuration, FORE, PerArm, SIDE, Wrench, YAW};
use crate::maths::scalar;
use crate::params::Params;

/// Rotor positions and senses of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Sideways lever d, m.
    pub d: f32,
    /// Fore-aft lever b, m.
    pub b: f32,
    /// Signed drag ratio χ k_q, m: positive for configuration B.
    pub drag: f32,
    /// 1/d and 1/b, 1/m.
    per_lever: (f32, f32),
}

impl Geometry {
    /// From levers `d` and `b` (m, > 0) and the signed drag ratio `drag` (m).
    pub fn new(d: f32, b: f32, drag: f32) -> Self {
        Self {
            d,
            b,
            drag,
            per_lever: (1.0 / d, 1.0 / b),
        }
    }

    /// From the parameters; the configuration gives the drag's sign.
    pub fn from_params(p: &Params, configuration: Configuration) -> Self {
        Self::new(p.arm_d, p.arm_b, configuration.chi() * p.torque_ratio)
    }

    /// With configuration B's drag sign: its yaw moments are these times the sign of this drag.
    pub fn as_b(&self) -> Self {
        if self.drag < 0.0 {
            Self {
                b: -self.b,
                drag: -self.drag,
                ..*self
            }
        } else {
            *self
        }
    }

    /// Wrench of the thrusts (N) of rotors tilted by `tilt` (rad).
    pub fn wrench(&self, thrusts: &PerArm<f32>, tilt: &PerArm<f32>) -> Wrench {
        let mut w = Wrench::default();
        for ((t, a), (side, (fore, yaw))) in thrusts
            .iter()
            .zip(tilt)
            .zip(SIDE.iter().zip(FORE.iter().zip(&YAW)))
        {
            let lift = t * scalar::cos(*a);
            w.thrust += lift;
            w.roll += side * self.d * t;
            w.pitch += fore * self.b * lift;
            w.yaw += yaw * t * (self.b * scalar::sin(*a) + self.drag);
        }
        w
    }
}

/// Tilt-dependent rows of the effectiveness; the roll row is always ±d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effectiveness {
    /// d(lift)/dT of each rotor, 1; times ±b it is the pitch entry.
    pub lift: PerArm<f32>,
    /// |d(yaw)/dT| with the authority's sign, m; times the rotor's yaw sign it is the entry.
    pub yaw: PerArm<f32>,
}

impl Effectiveness {
    /// At frozen tilt: before the arm has moved.
    pub fn frozen(geometry: &Geometry, tilt: &PerArm<f32>) -> Self {
        Self {
            lift: tilt.map(scalar::cos),
            yaw: tilt.map(|a| geometry.b * scalar::sin(a) + geometry.drag),
        }
    }

    /// Quasi-static: once the arm has followed; `tilt` and `follow` (T dα/dT) in rad, |tilt| <= 0.7.
    #[inline(always)]
    pub fn quasi_static(geometry: &Geometry, tilt: &PerArm<f32>, follow: &PerArm<f32>) -> Self {
        let rows = |tilt: f32, follow: f32| {
            let (s, c) = scalar::sin_cos_small(tilt);
            // First: the rotors' present moment shares it.
            let frozen = geometry.b * s + geometry.drag;
            (c - s * follow, frozen + geometry.b * c * follow)
        };
        let ([a1, a2, a3, a4], [f1, f2, f3, f4]) = (*tilt, *follow);
        let (l1, y1) = rows(a1, f1);
        let (l2, y2) = rows(a2, f2);
        let (l3, y3) = rows(a3, f3);
        let (l4, y4) = rows(a4, f4);
        Self {
            lift: [l1, l2, l3, l4],
            yaw: [y1, y2, y3, y4],
        }
    }
}

/// A wrench as lifts of the pairs and difference of the sides.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Lift of the front pair, N.
    pub front: f32,
    /// Lift of the rear pair, N.
    pub rear: f32,
    /// Left less right thrust, N.
    pub roll: f32,
    /// Yaw moment, N·m.
    pub yaw: f32,
}

impl Load {
    /// Load of wrench `w`.
    #[inline(always)]
    pub fn of(geometry: &Geometry, w: Wrench) -> Self {
        let (per_d, per_b) = geometry.per_lever;
        let pitch = w.pitch * per_b;
        Self {
            front: 0.5 * (w.thrust + pitch),
            rear: 0.5 * (w.thrust - pitch),
            roll: w.roll * per_d,
            yaw: w.yaw,
        }
    }

    /// Effect of the thrusts (N) of rotors tilted by `tilt` (rad, within ±0.7).
    #[inline(always)]
    pub fn given(geometry: &Geometry, thrusts: &PerArm<f32>, tilt: &PerArm<f32>) -> Self {
        let rotor = |thrust: f32, tilt: f32| {
            let (s, c) = scalar::sin_cos_small(tilt);
            (thrust * c, thrust * (geometry.b * s + geometry.drag))
        };
        let ([t1, t2, t3, t4], [a1, a2, a3, a4]) = (*thrusts, *tilt);
        let (l1, y1) = rotor(t1, a1);
        let (l2, y2) = rotor(t2, a2);
        let (l3, y3) = rotor(t3, a3);
        let (l4, y4) = rotor(t4, a4);
        Self {
            front: l1 + l3,
            rear: l2 + l4,
            roll: (t1 + t2) - (t3 + t4),
            yaw: y1 - y2 - y3 + y4,
        }
    }
}

/// Closed-form inverse of an effectiveness.
///
/// Lift and pitch rows give each pair's lift; a 2×2 system then splits the pairs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inverse {
    inv_lift_3: f32,
    inv_lift_4: f32,
    ratio_front: f32,
    ratio_rear: f32,
    yaw_3: f32,
    yaw_4: f32,
    /// Rotor 1 for roll (N/N) and yaw (N/(N·m)).
    first: (f32, f32),
    /// Rotor 2 for roll and against yaw.
    second: (f32, f32),
}

impl Inverse {
    /// The inverse; `None` if the effectiveness is singular.
    #[inline(always)]
    pub fn new(e: &Effectiveness) -> Option<Self> {
        /// Least determinant, m: 1 % of the stiff frame's yaw authority.
        const LEAST: f32 = 1.6e-4;
        let [l1, l2, l3, l4] = e.lift;
        let [y1, y2, y3, y4] = e.yaw;
        let (inv_lift_3, inv_lift_4) = (1.0 / l3, 1.0 / l4);
        let (ratio_front, ratio_rear) = (l1 * inv_lift_3, l2 * inv_lift_4);
        let (yaw_front, yaw_rear) = (y1 + y3 * ratio_front, y2 + y4 * ratio_rear);
        let (both_front, both_rear) = (1.0 + ratio_front, 1.0 + ratio_rear);
        let determinant = both_front * yaw_rear + both_rear * yaw_front;
        let per = 1.0 / determinant;
        // A lift of 0 makes the determinant infinite or NaN.
        (determinant.abs() > LEAST && determinant.abs() < f32::MAX).then_some(Self {
            inv_lift_3,
            inv_lift_4,
            ratio_front,
            ratio_rear,
            yaw_3: y3,
            yaw_4: y4,
            first: (yaw_rear * per, both_rear * per),
            second: (yaw_front * per, both_front * per),
        })
    }

    /// Thrusts (N) that give `load`.
    #[inline(always)]
    pub fn solve(&self, load: Load) -> PerArm<f32> {
        // Lifts of the pairs, first on rotors 3 and 4 alone.
        let (f3, r4) = (load.front * self.inv_lift_3, load.rear * self.inv_lift_4);
        // Roll and yaw gained as rotors 1 and 2 take over from 3 and 4.
        let roll = load.roll + f3 + r4;
        let yaw = load.yaw + self.yaw_3 * f3 - self.yaw_4 * r4;
        let t1 = roll * self.first.0 + yaw * self.first.1;
        let t2 = roll * self.second.0 - yaw * self.second.1;
        [t1, t2, f3 - self.ratio_front * t1, r4 - self.ratio_rear * t2]
    }

    /// Thrusts (N) for the yaw moment `yaw` (N·m) alone.
    #[inline(always)]
    pub fn solve_yaw(&self, yaw: f32) -> PerArm<f32> {
        let (t1, t2) = (yaw * self.first.1, yaw * self.second.1);
        [t1, -t2, -self.ratio_front * t1, self.ratio_rear * t2]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::allocation::arm_deflection::ArmModel;

    fn geometry() -> Geometry {
        Geometry::new(0.178, 0.178, 0.016)
    }

    fn quasi_static(g: &Geometry, m: &ArmModel, thrust: f32) -> Effectiveness {
        Effectiveness::quasi_static(g, &[m.angle(thrust); 4], &[thrust * m.slope(thrust); 4])
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
            // Arm hinged at the centre line: its tip, and the perpendicular thrust.
            let r = crate::maths::vector::Vec3::new(fore * g.b, -left * g.d * a.cos(), -g.d * a.sin());
            let f = crate::maths::vector::Vec3::new(0.0, left * t * a.sin(), -t * a.cos());
            let m = r.cross(f);
            // Rotors 1 and 4 turn counter-clockwise from above; their drag turns the body clockwise.
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
        let quasi = |t: f32| quasi_static(&g, &m, t).yaw[0];
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
        let e = quasi_static(&g, &m, t);
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
            let inverse = Inverse::new(&e).expect("regular");
            let t = inverse.solve(Load::of(&g, Wrench { thrust, roll, pitch, yaw: turn }));
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
            let (only, yaw) = (Load { yaw: turn, ..Load::default() }, inverse.solve_yaw(turn));
            for (a, b) in inverse.solve(only).into_iter().zip(yaw) {
                prop_assert!((a - b).abs() < 1e-5);
            }
        }

        #[test]
        fn the_load_is_the_wrench_on_its_levers(
            thrusts in prop::array::uniform4(0.2f32..8.3), tilt in prop::array::uniform4(-0.7f32..0.7), side in prop::bool::ANY,
        ) {
            let sign = if side { 1.0 } else { -1.0 };
            let g = Geometry::new(0.2, 0.15, sign * 0.016);
            let (want, got) = (Load::of(&g, g.wrench(&thrusts, &tilt)), Load::given(&g, &thrusts, &tilt));
            // The wrench uses micromath's sines.
            prop_assert!((want.front - got.front).abs() < 0.04 && (want.rear - got.rear).abs() < 0.04);
            prop_assert!((want.roll - got.roll).abs() < 1e-4 && (want.yaw - got.yaw).abs() < 0.01);
            let b = Load::given(&g.as_b(), &thrusts, &tilt);
            prop_assert!((b.yaw - sign * got.yaw).abs() < 1e-6);
        }
    }
}
