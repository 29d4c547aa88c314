//! Interface of the plant to an arm, for both models of bending.

use glam::DVec3;

use super::contact::{Pipe, Pose};
use super::load::{Acceleration, Load};
use super::mass_matrix::MassMatrix;

/// Model of an arm's bending.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmBending {
    /// A rigid link on a hinge at the centre line: the paper's model, for its tables.
    Hinge,
    /// A beam that bends along its length.
    Beam,
}

/// Surfaces that are near enough for a touch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nearby {
    /// The pipe, if it is near.
    pub pipe: Option<Pipe>,
    /// Whether the ground is near.
    pub ground: bool,
    /// Rebound of the skin, as [`Pad::rebound`](super::contact::Pad::rebound).
    pub rebound: f64,
}

/// Loads of a step on one arm other than contact.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drive {
    /// Length of the step, s.
    pub dt: f64,
    /// Time that passes for slow processes of the material, s.
    pub slow: f64,
    /// Thrust of the rotor, N.
    pub thrust: f64,
    /// Moment of the tendon on the tip's tilt, N·m.
    pub tendon: f64,
    /// Angular momentum of the rotor along its axis, N·m·s.
    pub momentum: f64,
    /// Moment of the rotor's drag along its axis, N·m.
    pub drag: f64,
}

/// Motion of the body that carries the arms.
#[derive(Clone, Copy, Debug)]
pub struct Carrier {
    /// Angular rate, rad/s, body.
    pub omega: DVec3,
    /// Gravity, m/s², body.
    pub gravity: DVec3,
    /// Whether the arms' masses act on the body.
    pub coupled: bool,
}

/// An arm on the body that carries it.
pub trait Carried {
    /// Adds the arm's mass, and the forces that it passes on, to the body's equations.
    fn condense(&self, carrier: &Carrier, mass: &mut MassMatrix, load: &mut Load);

    /// Adds the thrust alone: an arm without mass.
    fn condense_massless(&self, load: &mut Load);
}

/// An arm with its contacts. A step is `touch`, `drive`, `condense` and `advance`.
pub trait Flexible: Carried {
    /// Tilt of the tip, rad.
    fn tilt(&self) -> f64;

    /// Points of the underside that may touch the pipe, m, body.
    fn underside(&self) -> [DVec3; 3];

    /// Hangs a weight of `newtons` N on the rotor's mount, by a string.
    fn hang(&mut self, newtons: f64);

    /// Finds the contact forces, adds them to `load` and stores their effect on the arm for [`Flexible::drive`].
    /// Returns the pressure at the sensor, Pa.
    fn touch(&mut self, dt: f64, pose: &Pose, nearby: &Nearby, load: &mut Load) -> f64;

    /// Sums the loads on the arm's own motion; adds to `load` the rotor's moments on the body.
    fn drive(&mut self, drive: &Drive, carrier: &Carrier, load: &mut Load);

    /// Advances by `dt` s on a body with the acceleration `body`.
    fn advance(&mut self, dt: f64, body: &Acceleration, carrier: &Carrier);
}
