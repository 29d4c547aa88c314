//! From a tendon's force to the pulse of the servo that winds it, and back to the force that it can give.
//!
//! [`TendonDrive::step`] is called at the servos' frame rate (50 to 333 Hz) with the time since the step before (s).
//! Angles of the servo are from its release position (rad), tilts positive with the arm's tip up (rad), forces along
//! the tendon (N). A missed step leaves the servo at its last pulse, and the force lags behind by a frame.
//!
//! The reel must take up what the arm's tilt gives away, h (α_ref - α), and then stretch the tendon by F/k.
//! The tilt comes late and noisy from the arm's own sensor, and feeding it to the reel is a positive feedback
//! (a tighter tendon bends the arm, which asks for more reel), so it is low-passed well below the arm's
//! bending mode. What that lag hides is reported by the tension observer, which extrapolates over it.

mod drive;
mod force_limit;
mod reel;
#[cfg(test)]
mod tests;

pub use self::drive::{Drive, TILT_CUTOFF, TendonDrive};
pub use self::force_limit::ForceLimit;
pub use self::reel::{REFERENCE_TILT, Reel, SPAN_MIN_US};
