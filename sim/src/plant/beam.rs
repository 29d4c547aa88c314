//! The arm as a beam that bends along its length.
//!
//! A tip thrust bends a beam less the farther out, a tendon along it bends it alike everywhere. The shape has two
//! terms, θ(ξ) = q1 ξ + q2 ξ², θ the slope at the share ξ of the length: both loads alone give exact tilts. A tip carries
//! motor and propeller, which also twist about the arm ([`twist`]). Derivations and limit cases: docs/design/physics.md.
//!
//! The neutral line lies at [`HINGE_Z`] at the root; the underside [`DEPTH`] below it.

mod arm;
pub mod in_plane;
mod masses;
pub mod material;
pub mod rest;
mod section;
mod shape;
mod skin;
#[cfg(test)]
mod tests;
pub mod twist;

pub use self::arm::BeamArm;
pub use self::masses::Masses;
pub use self::section::BeamSpec;

use super::contact::{HINGE_Z, UNDERSIDE_Z};

/// Underside below the neutral line, m: half the height of the section.
pub const DEPTH: f64 = UNDERSIDE_Z - HINGE_Z;
/// Tendon from the neutral line, m: along the underside, where an arm that lies on a pipe has room for it (derived: at
/// 25 mm it would run inside the pipe).
pub const TENDON_LEVER: f64 = DEPTH;

/// Coordinates of the shape.
pub(super) const TERMS: usize = 2;
/// A value of each term.
pub(super) type PerTerm = [f64; TERMS];
