//! What one link may send: a token bucket of bytes.

/// Share of a second that may be saved up: as many bytes may follow each other without a pause.
const SAVED_US: u64 = 250_000;
/// Least that can be saved up, bytes: an answer and the longest frame.
const SAVED_MIN: u64 = 400;
/// Kept back from streams for heartbeats, answers and texts, bytes.
pub const RESERVE: u32 = 120;

/// The bytes of one link.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Bytes each second.
    rate: u32,
    /// Bytes saved up, in millionths.
    saved: u64,
    /// When they were last added to, µs.
    at: u64,
    /// Bytes that each frame takes beside its own.
    extra: u32,
}

impl Budget {
    /// A link that may send `rate` bytes each second.
    pub const fn new(rate: u32) -> Self {
        Self {
            rate,
            saved: 0,
            at: 0,
            extra: 0,
        }
    }

    const fn most(&self) -> u64 {
        let share = self.rate as u64 * SAVED_US / 1_000_000;
        1_000_000 * if share > SAVED_MIN { share } else { SAVED_MIN }
    }

    /// Adds what has come since the last time; `now` in µs.
    pub fn refill(&mut self, now: u64) {
        let added = now.saturating_sub(self.at).saturating_mul(self.rate.into());
        self.at = now.max(self.at);
        self.saved = self.saved.saturating_add(added).min(self.most());
    }

    /// Counts `extra` bytes more for each frame.
    pub const fn add_to_each(&mut self, extra: u32) {
        self.extra = extra;
    }

    /// True where a frame of `bytes` may be sent now.
    pub const fn allows(&self, bytes: u32) -> bool {
        self.saved >= (bytes as u64 + self.extra as u64) * 1_000_000
    }

    /// Takes `bytes` that were sent.
    pub fn spend(&mut self, bytes: u32) {
        self.saved = self.saved.saturating_sub(u64::from(bytes) * 1_000_000);
    }
}
