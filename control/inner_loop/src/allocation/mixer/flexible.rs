//! The allocation that flies: the wrench inverted through the quasi-static Jacobian about the low-passed thrusts.
//!
//! Inverting the effectiveness at the frozen arm angle is wrong even with the true angle: a thrust changed for yaw soon
//! bends its arm and yaws |C| times more, and an inverse that follows the angle makes a limit cycle.

#[cfg(test)]
mod tests;

use crate::allocation::arm_tilt::TiltModel;
use crate::allocation::desaturation::Patterns;
use crate::allocation::effectiveness::{Effectiveness, Geometry, Inverse, Load};
use crate::allocation::mixer::{Allocation, Conditions, Limits, Mix, Split, moment_patterns, stiff};
use crate::allocation::wrench::{Configuration, PerArm, Wrench};
use crate::maths::scalar;
use crate::params::Params;

/// Share of the stiff frame's yaw authority k_q below which yaw fades and entries are floored.
pub const YAW_FLOOR: f32 = 0.35;

/// Allocation by the quasi-static Jacobian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flexible {
    geometry: Geometry,
    /// Geometry of configuration B, and the sign towards it.
    geometry_b: Geometry,
    chi: f32,
    tilt: TiltModel,
    limits: Limits,
    /// Least entry of the yaw row, m.
    yaw_floor: f32,
    /// Slope of yaw's share over the authority, 1/m: 0 at half the floor, 1 at the floor.
    fade_slope: f32,
}

impl Flexible {
    /// An allocation with idle rotors.
    pub fn new(configuration: Configuration, p: &Params) -> Self {
        let geometry = Geometry::from_params(p, configuration);
        Self {
            geometry,
            geometry_b: geometry.in_configuration_b(),
            chi: configuration.chi(),
            tilt: TiltModel::new(p),
            limits: Limits::new(p),
            yaw_floor: YAW_FLOOR * p.torque_ratio,
            fade_slope: 2.0 / (YAW_FLOOR * p.torque_ratio),
        }
    }

    /// T = Tt + J⁻¹ (w - w(Tt)), J the static Jacobian at the low-passed thrusts Tt.
    #[inline(always)]
    fn quasi_static(&self, wrench: &Wrench, yaw_usable: bool) -> Split {
        let (thrusts, tilt) = (self.tilt.thrusts(), self.tilt.tilt());
        // In A yaw acts the other way: allocated as in B, with the moment reversed.
        let geometry = self.geometry_b;
        let w = Wrench {
            yaw: self.chi * wrench.yaw,
            ..*wrench
        };
        let mut e = Effectiveness::quasi_static(&geometry, &tilt, &self.tilt.follow());
        // Yaw fades with its quasi-static gain, and no entry may pass zero: the inverse of a vanishing entry is a kick,
        // a reversed authority unreliable.
        let [y1, y2, y3, y4] = e.yaw;
        let authority = 0.25 * (y1 + y2 + y3 + y4);
        let least = self.yaw_floor;
        let fade = scalar::clamp(authority * self.fade_slope - 1.0, 0.0, 1.0);
        let fade = if yaw_usable { fade } else { 0.0 };
        e.yaw = e.yaw.map(|y| if y > least { y } else { least });
        let Some(inverse) = Inverse::new(&e) else {
            return self.without_yaw(wrench);
        };
        let now = Load::given(&geometry, &thrusts, &tilt);
        let half = 0.5 * w.thrust;
        let [c1, c2, c3, c4] = inverse.solve(Load {
            front: half - now.front,
            rear: half - now.rear,
            roll: -now.roll,
            yaw: -now.yaw * fade,
        });
        let [t1, t2, t3, t4] = thrusts;
        let (c1, c2, c3, c4) = (t1 + c1, t2 + c2, t3 + c3, t4 + c4);
        // The collective continues from the last thrusts, without their share of the yaw pattern where yaw is given up:
        // nothing else corrects it, and thrust, roll and pitch are unaffected.
        let left = (0.25 - 0.25 * fade) * (c1 - c2 - c3 + c4);
        let patterns = Patterns {
            collective: [c1 - left, c2 + left, c3 + left, c4 - left],
            ..moment_patterns(&geometry, &inverse, w)
        };
        Split { patterns, fade }
    }

    /// Without yaw authority: the stiff frame's patterns still give thrust, roll and pitch.
    #[cold]
    fn without_yaw(&self, w: &Wrench) -> Split {
        Split {
            fade: 0.0,
            ..stiff(&self.geometry, Wrench { yaw: 0.0, ..*w }, [0.0; 4])
        }
    }
}

impl Allocation for Flexible {
    // Not inlined: in a caller built for size its loops would cost twice as much.
    #[inline(never)]
    fn allocate(&mut self, w: &Wrench, c: Conditions) -> Mix {
        if !w.is_finite() {
            return self.limits.at_idle();
        }
        let ratio = Limits::thrust_ratio(c.thrust_ratio);
        let open = self.limits.open_yaw(self.tilt.thrusts());
        let usable = c.yaw && open;
        let split = self.quasi_static(w, usable);
        self.limits.give(split, usable, ratio)
    }

    fn at_idle(&self) -> Mix {
        self.limits.at_idle()
    }

    // Not inlined, like `allocate`.
    #[inline(never)]
    fn follow(&mut self, thrusts: &PerArm<f32>, dt: f32) {
        self.tilt.step(thrusts, dt);
    }

    #[inline(always)]
    fn tilt(&self) -> &TiltModel {
        &self.tilt
    }

    #[inline(always)]
    fn tilt_mut(&mut self) -> &mut TiltModel {
        &mut self.tilt
    }
}
