//! When something was measured by a sender whose clock is another: by TIMESYNC, as the standard has it.

use super::Refusal;
use crate::requests::Peer;

/// Time between two questions for the sender's time, µs.
const PERIOD: u64 = 1_000_000;
/// The longest way there and back that says something of the sender's clock, µs: its offset is known to half of it.
const WAY_MAX: u64 = 100_000;
/// Growth of the shortest way with each question, so that a clock that drifts is followed.
const WAY_GROWTH: u64 = 2_000;
/// Age beyond which a measurement is of no use, µs.
const AGE_MAX: u64 = 1_000_000;
/// What a clock may be ahead, µs: what its offset is known to.
const AHEAD_MAX: u64 = WAY_MAX / 2;

/// How a time of measurement is known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TimeSource {
    /// It is the time of receipt, since nothing is known of the sender's clock.
    #[default]
    Receipt,
    /// The sender's clock is the vehicle's.
    Vehicle,
    /// By the sender's clock and its offset.
    Offset,
}

/// A time of the vehicle's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    /// µs since the start.
    pub at: u64,
    /// How it is known.
    pub source: TimeSource,
}

/// The clock of the sender of poses.
#[derive(Clone, Debug)]
pub struct Clock {
    of: Option<Peer>,
    /// When it is asked next, µs.
    ask_at: u64,
    /// When the last question went out, µs.
    asked_at: Option<u64>,
    /// Its time less the vehicle's, µs, and the way of the answer that it is from.
    offset: Option<i64>,
    way: u64,
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

impl Clock {
    /// Nothing is known.
    pub const fn new() -> Self {
        Self {
            of: None,
            ask_at: 0,
            asked_at: None,
            offset: None,
            way: WAY_MAX,
        }
    }

    /// True where `peer` is to be asked at `now`, µs.
    pub(super) fn due(&mut self, peer: Peer, now: u64) -> bool {
        if self.of != Some(peer) {
            *self = Self {
                of: Some(peer),
                ..Self::new()
            };
        }
        let due = now >= self.ask_at;
        if due {
            self.ask_at = now.saturating_add(PERIOD);
        }
        due
    }

    /// Whom to ask; the question goes out at `now`, µs.
    pub(crate) fn ask(&mut self, now: u64) -> Option<Peer> {
        self.asked_at = Some(now);
        self.way = self.way.saturating_add(WAY_GROWTH).min(WAY_MAX);
        self.of
    }

    /// Takes an answer that arrived at `now`, µs: the sender's time `theirs` at the question of `ours`, both in ns.
    pub(crate) fn answer(&mut self, from: Peer, theirs: i64, ours: i64, now: u64) {
        let Some(asked_at) = self.asked_at.filter(|_| self.of == Some(from)) else {
            return;
        };
        let way = now.saturating_sub(asked_at);
        if i64::try_from(asked_at.saturating_mul(1000)) != Ok(ours) || way > self.way {
            return;
        }
        self.asked_at = None;
        self.way = way;
        let middle = i64::try_from(asked_at.saturating_add(way / 2)).unwrap_or(i64::MAX);
        self.offset = Some((theirs / 1000).saturating_sub(middle));
    }

    /// When what `from` sent with the time `usec` of its clock, and arrived at `now`, was measured.
    pub(super) fn time(&self, usec: u64, from: Peer, now: u64) -> Result<Time, Refusal> {
        let recent = |at: u64| at <= now.saturating_add(AHEAD_MAX) && now.saturating_sub(at) <= AGE_MAX;
        let offset = self.offset.filter(|_| self.of == Some(from));
        let by_offset = offset.and_then(|offset| usec.checked_add_signed(offset.checked_neg()?));
        // A clock that agrees by chance must not win over one that is known.
        let (at, source) = match (by_offset.filter(|&at| recent(at)), offset) {
            (Some(at), _) => (at, TimeSource::Offset),
            _ if recent(usec) => (usec, TimeSource::Vehicle),
            (None, Some(_)) => return Err(Refusal::Late),
            (None, None) => (now, TimeSource::Receipt),
        };
        Ok(Time {
            at: at.min(now),
            source,
        })
    }
}
