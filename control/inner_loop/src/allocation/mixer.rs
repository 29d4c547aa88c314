//! Allocation of a wrench to four rotors whose arms bend, recomputed at 1 kHz.
//!
//! [`Flexible`] flies. The mixer task takes any [`Allocation`]; the simulator flies others of the same parts:
//! [`Limits`] of rotors and yaw, and the [`Split`] of a wrench.

mod flexible;
mod limits;
mod split;

pub use flexible::{Flexible, YAW_FLOOR};
pub use limits::Limits;
pub use split::{Split, moment_patterns, stiff};

use crate::allocation::arm_tilt::TiltModel;
use crate::allocation::desaturation::Given;
use crate::allocation::wrench::{PerArm, Wrench};

/// Result of one step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mix {
    /// Thrust of each rotor, N, within the idle and the battery's limit.
    pub thrusts: PerArm<f32>,
    /// Shares given.
    pub given: Given,
    /// Yaw was given up for lack of authority; its integrator is to be reset.
    pub yaw_gated: bool,
}

/// Inputs of an allocation besides the wrench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Yaw may be used.
    pub yaw: bool,
    /// Root of the largest thrust over that of the parameters, limited to 0.5..1.25: by battery and rotors.
    pub thrust_ratio: f32,
    /// Step time, s, > 0.
    pub dt: f32,
}

/// Turns wrenches into thrusts at the arms' modelled tilt.
pub trait Allocation {
    /// Thrusts for the wrench `w` (N, N·m) at the present tilt; idle if `w` is not finite.
    fn allocate(&mut self, w: &Wrench, c: Conditions) -> Mix;

    /// Rotors at idle.
    fn at_idle(&self) -> Mix;

    /// Steps the models of arms and motors by `dt` s with the sent thrusts (N).
    fn follow(&mut self, thrusts: &PerArm<f32>, dt: f32);

    /// The arms' modelled tilt.
    fn tilt(&self) -> &TiltModel;

    /// The arms' modelled tilt, for correction by the sensors.
    fn tilt_mut(&mut self) -> &mut TiltModel;

    /// One step: [`Self::allocate`], then [`Self::follow`].
    #[inline(always)]
    fn mix(&mut self, w: &Wrench, c: Conditions) -> Mix {
        let mix = self.allocate(w, c);
        self.follow(&mix.thrusts, c.dt);
        mix
    }

    /// One step of `dt` s with the rotors at idle.
    fn idle(&mut self, dt: f32) -> Mix {
        let mix = self.at_idle();
        self.follow(&mix.thrusts, dt);
        mix
    }
}
