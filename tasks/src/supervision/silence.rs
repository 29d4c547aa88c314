//! Refuses arming while a sensor is silent.

use embassy_time::{Duration, Instant};
use sophie_control::arming::ArmingInhibit;

use crate::links::Links;

/// Watches one sensor's readings.
pub struct SilenceWatch {
    reason: ArmingInhibit,
    limit: Duration,
    last: Instant,
    silent: bool,
}

impl SilenceWatch {
    /// Reports `reason` after `limit` without a reading, from `since` on.
    pub const fn new(reason: ArmingInhibit, limit: Duration, since: Instant) -> Self {
        Self {
            reason,
            limit,
            last: since,
            silent: false,
        }
    }

    /// When the sensor becomes silent without a further reading.
    pub fn due(&self) -> Instant {
        self.last + self.limit
    }

    /// Notes a reading, or a request for one, at `now`.
    pub fn heard(&mut self, links: &Links, now: Instant) {
        // A reading before the start is over must not bring its end forward.
        self.last = self.last.max(now);
        self.look(links, now);
    }

    /// Reports a silence that has begun or ended by `now`.
    pub fn look(&mut self, links: &Links, now: Instant) {
        let silent = now.saturating_duration_since(self.last) >= self.limit;
        if silent != self.silent {
            self.silent = silent;
            links.report(self.reason, silent);
        }
    }
}
