//! Data-ready line.

use embassy_time::Instant;

/// A data-ready line. A wait may be dropped; a pulse without a pending wait is lost.
pub trait DataReady {
    /// Waits for the next sample; returns the time at which it was ready.
    async fn next(&mut self) -> Instant;
}
