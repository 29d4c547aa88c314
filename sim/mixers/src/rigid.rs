//! The allocation of a rigid frame.

use sophie_control::allocation::effectiveness::Geometry;
use sophie_control::allocation::mixer::{Split, stiff};
use sophie_control::allocation::wrench::{Configuration, Wrench};
use sophie_control::params::Params;

use crate::law::{Law, Situation};

/// Rigid, level arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    geometry: Geometry,
}

impl Rigid {
    /// The law for the vehicle of the parameters.
    pub fn new(configuration: Configuration, p: &Params) -> Self {
        Self {
            geometry: Geometry::from_params(p, configuration),
        }
    }
}

impl Law for Rigid {
    fn split(&self, w: Wrench, _: &Situation<'_>) -> Split {
        stiff(&self.geometry, w, [0.0; 4])
    }
}
