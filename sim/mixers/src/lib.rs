//! Allocations of `--mixer` and scenario files: three for study, one that flies. Each [`Law`] splits a wrench into
//! patterns of thrust; [`WithLimits`] adds limits and the flexible allocation's tilt model.

#![no_std]

mod frozen;
mod law;
mod printed;
mod rigid;

pub use frozen::Frozen;
pub use law::{Law, Situation, WithLimits};
pub use printed::Printed;
pub use rigid::Rigid;

use sophie_control::allocation::arm_tilt::TiltModel;
use sophie_control::allocation::mixer::{Allocation, Conditions, Flexible, Mix};
use sophie_control::allocation::wrench::{Configuration, PerArm, Wrench};
use sophie_control::chain::MixingStep;
use sophie_control::params::Params;

/// The allocation in use.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Variant {
    /// Rigid arms.
    Rigid,
    /// Algorithm 1 with the printed matrix, its singular yaw row corrected; tilt only in the thrust row.
    Paper,
    /// Inverse effectiveness at the frozen arm angle; limit-cycles.
    Frozen,
    /// Quasi-static Jacobian about the low-passed thrust: the one that flies.
    #[default]
    Flexible,
}

/// An allocation of any [`Variant`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mixer {
    /// [`Variant::Rigid`].
    Rigid(WithLimits<Rigid>),
    /// [`Variant::Paper`].
    Paper(WithLimits<Printed>),
    /// [`Variant::Frozen`].
    Frozen(WithLimits<Frozen>),
    /// [`Variant::Flexible`].
    Flexible(Flexible),
}

impl Mixer {
    /// The allocation of `variant` with idle rotors.
    pub fn new(variant: Variant, configuration: Configuration, p: &Params) -> Self {
        match variant {
            Variant::Rigid => Self::Rigid(WithLimits::new(Rigid::new(configuration, p), p)),
            Variant::Paper => Self::Paper(WithLimits::new(Printed::new(configuration, p), p)),
            Variant::Frozen => Self::Frozen(WithLimits::new(Frozen::new(configuration, p), p)),
            Variant::Flexible => Self::Flexible(Flexible::new(configuration, p)),
        }
    }

    fn chosen(&self) -> &dyn Allocation {
        match self {
            Self::Rigid(mixer) => mixer,
            Self::Paper(mixer) => mixer,
            Self::Frozen(mixer) => mixer,
            Self::Flexible(mixer) => mixer,
        }
    }

    fn chosen_mut(&mut self) -> &mut dyn Allocation {
        match self {
            Self::Rigid(mixer) => mixer,
            Self::Paper(mixer) => mixer,
            Self::Frozen(mixer) => mixer,
            Self::Flexible(mixer) => mixer,
        }
    }
}

impl Allocation for Mixer {
    fn allocate(&mut self, w: &Wrench, c: Conditions) -> Mix {
        self.chosen_mut().allocate(w, c)
    }

    fn at_idle(&self) -> Mix {
        self.chosen().at_idle()
    }

    fn follow(&mut self, thrusts: &PerArm<f32>, dt: f32) {
        self.chosen_mut().follow(thrusts, dt);
    }

    fn tilt(&self) -> &TiltModel {
        self.chosen().tilt()
    }

    fn tilt_mut(&mut self) -> &mut TiltModel {
        self.chosen_mut().tilt_mut()
    }
}

impl MixingStep for Mixer {}

#[cfg(test)]
mod tests;
