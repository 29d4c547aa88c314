//! Motors and tendon servos.

use embassy_time::Instant;
use sophie_control::allocation::wrench::PerArm;

/// The four motors.
pub trait Motors {
    /// Sends one command for each output: 0 stops, 0 < c <= 1 is the share of full drive. Returns the time at which the
    /// frame began.
    async fn write(&mut self, commands: PerArm<f32>) -> Instant;
}

/// The four tendon servos.
pub trait Servos {
    /// Sets one pulse width for each servo, µs; 0 switches the servo's pulse off. Returns the time at which the first
    /// pulses of these widths begin, mostly in the future: the widths take effect with the next frame.
    async fn write(&mut self, pulses_us: PerArm<f32>) -> Instant;
}
