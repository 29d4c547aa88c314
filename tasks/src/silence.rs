//! Sensors that give nothing: reported against arming when their silence begins, and cleared when it ends.

use embassy_time::{Duration, Instant};
use sophie_control::arming::ArmingInhibit;

use crate::links::Links;

/// Watches for readings of one sensor.
pub struct SilenceWatch {
    reason: ArmingInhibit,
    limit: Duration,
    /// When it last gave a reading.
    last: Instant,
    silent: bool,
}

impl SilenceWatch {
    /// Reports `reason` once the sensor has given nothing for `limit`, counted from `since` at the earliest.
    pub const fn new(reason: ArmingInhibit, limit: Duration, since: Instant) -> Self {
        Self {
            reason,
            limit,
            last: since,
            silent: false,
        }
    }

    /// When the sensor counts as silent, unless a reading comes before.
    pub fn due(&self) -> Instant {
        self.last + self.limit
    }

    /// A reading came at `now`, or was asked for then.
    pub fn heard(&mut self, links: &Links, now: Instant) {
        // One that came before the start was over must not bring its end forward.
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
