//! Byte budget of one line, as a token bucket.

/// Largest saving, as time at the line's rate, µs: so many bytes may follow each other without a pause.
const SAVED_US: u64 = 250_000;
/// Least capacity of the saving, bytes: an answer and the longest frame.
const SAVED_MIN: u64 = 400;
/// Reserve that streams leave for heartbeats, answers and texts, bytes.
pub const RESERVE: u32 = 120;

/// The budget of one line.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    /// Bytes each second.
    rate: u32,
    /// Bytes saved up, in millionths.
    saved: u64,
    /// Time of the last refill, µs.
    at: u64,
    /// Further bytes of each frame: the signature.
    extra: u32,
}

impl Budget {
    /// A line that may send `rate` bytes each second.
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

    /// Adds the bytes that the time since the last call allows; `now` in µs.
    pub fn refill(&mut self, now: u64) {
        let added = now.saturating_sub(self.at).saturating_mul(self.rate.into());
        self.at = now.max(self.at);
        self.saved = self.saved.saturating_add(added).min(self.most());
    }

    /// Counts `extra` further bytes for each frame.
    pub const fn add_to_each(&mut self, extra: u32) {
        self.extra = extra;
    }

    /// True if a frame of `bytes` may be sent now.
    pub const fn allows(&self, bytes: u32) -> bool {
        self.saved >= (bytes as u64 + self.extra as u64) * 1_000_000
    }

    /// Subtracts `bytes` that were sent.
    pub fn spend(&mut self, bytes: u32) {
        self.saved = self.saved.saturating_sub(u64::from(bytes) * 1_000_000);
    }
}
