//! From a tendon's force to its servo's pulse, and back to the servo's possible tension.
//!
//! [`TendonDrive::step`] runs at the servos' frame rate (50 to 333 Hz). Servo angles are from release (rad), tilts
//! positive with the tip up (rad), forces along the tendon (N). A missed step keeps the last pulse.
//!
//! The reel takes up the slack of the arm's tilt, h (α_ref - α), then stretches the tendon by F/k. The measured tilt is
//! late and noisy, and it feeds back positively through the reel (a tighter tendon bends the arm, which needs more
//! reel), so it is low-passed well below the arm's bending mode. The tension observer extrapolates over that lag.

mod drive;
mod force_limit;
mod reel;
#[cfg(test)]
mod tests;

pub use self::drive::{Drive, TILT_CUTOFF, TendonDrive};
pub use self::force_limit::ForceLimit;
pub use self::reel::{REFERENCE_TILT, Reel, SPAN_MIN_US};
