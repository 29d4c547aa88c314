//! When something was measured by a sender whose clock is another: by TIMESYNC, as the standard has it.

use sophie_ports::external_pose::TimeSource;

use super::{INPUTS, Refusal};
use crate::wire::requests::Peer;

/// Time between two questions for a sender's time, µs.
const PERIOD: u64 = 1_000_000;
/// The longest way there and back that says something of the sender's clock, µs: its offset is known to half of it.
const WAY_MAX: u64 = 100_000;
/// Growth of the shortest way with each question, so that a clock that drifts is followed.
const WAY_GROWTH: u64 = 2_000;
/// Age beyond which a measurement is of no use, µs.
pub(super) const AGE_MAX: u64 = 1_000_000;
/// What a clock may be ahead, µs: what its offset is known to.
const AHEAD_MAX: u64 = WAY_MAX / 2;

/// A time of the vehicle's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    /// µs since the start.
    pub at: u64,
    /// How it is known.
    pub source: TimeSource,
}

/// A time of measurement by the sender's clock; 0 stands for none.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stamp {
    /// µs.
    Micros(u64),
    /// ms modulo 2^32, beside a clock of 64 bits: Unix time, or more than 49 days.
    Millis(u32),
}

impl Stamp {
    const fn given(self) -> bool {
        !matches!(self, Self::Micros(0) | Self::Millis(0))
    }

    /// The same by the vehicle's clock, µs, which is `offset` behind and shows `now`. Of the times that a short stamp stands
    /// for, the nearest. What is before the start comes out far ahead.
    fn by(self, offset: i64, now: u64) -> u64 {
        let theirs = match self {
            Self::Micros(theirs) => theirs,
            Self::Millis(theirs) => {
                let sent = now.wrapping_add_signed(offset) / 1000;
                let age = (sent as u32).wrapping_sub(theirs).cast_signed();
                sent.wrapping_add_signed(-i64::from(age)).wrapping_mul(1000)
            }
        };
        theirs.wrapping_sub(offset.cast_unsigned())
    }
}

/// What is known of a sender's clock.
#[derive(Clone, Copy, Debug)]
struct Clock {
    of: Peer,
    /// When it is asked next, µs.
    ask_at: u64,
    /// When the last question went out, µs.
    asked_at: Option<u64>,
    /// Its time less the vehicle's, µs, and the way of the answer that it is from.
    offset: Option<i64>,
    way: u64,
}

/// The clocks of the senders of which something was taken, on whatever line.
#[derive(Clone, Debug, Default)]
pub struct Clocks {
    /// One for each input: each has one source at a time, so a new source always finds one that is no source any more.
    known: [Option<Clock>; INPUTS],
}

impl Clocks {
    fn of(&mut self, peer: Peer) -> Option<&mut Clock> {
        self.known.iter_mut().flatten().find(|clock| clock.of == peer)
    }

    /// Keeps the clock of `peer`, of which something was taken; one of a sender that is not `needed` makes room.
    pub(super) fn keep(&mut self, peer: Peer, needed: impl Fn(Peer) -> bool) {
        if self.of(peer).is_some() {
            return;
        }
        let mut rooms = self.known.iter_mut();
        if let Some(room) = rooms.find(|room| room.is_none_or(|clock| !needed(clock.of))) {
            *room = Some(Clock {
                of: peer,
                ask_at: 0,
                asked_at: None,
                offset: None,
                way: WAY_MAX,
            });
        }
    }

    /// True where `peer` is to be asked at `now`, µs: once a second, if its clock is kept.
    pub(super) fn due(&mut self, peer: Peer, now: u64) -> bool {
        let due = self.of(peer).filter(|clock| now >= clock.ask_at);
        if let Some(clock) = due {
            clock.ask_at = now.saturating_add(PERIOD);
            return true;
        }
        false
    }

    /// The question to `peer` goes out at `now`, µs; false where its clock is kept no longer.
    pub(crate) fn ask(&mut self, peer: Peer, now: u64) -> bool {
        let Some(clock) = self.of(peer) else {
            return false;
        };
        clock.asked_at = Some(now);
        clock.way = clock.way.saturating_add(WAY_GROWTH).min(WAY_MAX);
        true
    }

    /// Takes an answer that arrived at `now`, µs: the sender's time `theirs` at the question of `ours`, both in ns.
    pub(crate) fn answer(&mut self, from: Peer, theirs: i64, ours: i64, now: u64) {
        let Some(clock) = self.of(from) else {
            return;
        };
        let Some(asked_at) = clock.asked_at else {
            return;
        };
        let way = now.saturating_sub(asked_at);
        if i64::try_from(asked_at.saturating_mul(1000)) != Ok(ours) || way > WAY_MAX {
            return;
        }
        let middle = i64::try_from(asked_at.saturating_add(way / 2)).unwrap_or(i64::MAX);
        let offset = (theirs / 1000).saturating_sub(middle);
        // Each is known to half of its way: what is farther off than both is another clock, whose sender started again.
        let other = clock.offset.is_some_and(|known| known.abs_diff(offset) > WAY_MAX);
        if way > clock.way && !other {
            return;
        }
        clock.asked_at = None;
        clock.way = way;
        clock.offset = Some(offset);
    }

    /// When what `from` sent with the time `stamp` of its clock, and arrived at `now`, was measured.
    pub(super) fn time(&self, stamp: Stamp, from: Peer, now: u64) -> Result<Time, Refusal> {
        let receipt = Time {
            at: now,
            source: TimeSource::Receipt,
        };
        if !stamp.given() {
            return Ok(receipt);
        }
        let clock = self.known.iter().flatten().find(|clock| clock.of == from);
        let offset = clock.and_then(|clock| clock.offset);
        // A clock that agrees by chance must not win over one that is known.
        for (offset, source) in [(offset, TimeSource::Offset), (Some(0), TimeSource::Vehicle)] {
            let Some(offset) = offset else {
                continue;
            };
            let at = stamp.by(offset, now);
            if at <= now.saturating_add(AHEAD_MAX) && now.saturating_sub(at) <= AGE_MAX {
                return Ok(Time {
                    at: at.min(now),
                    source,
                });
            }
        }
        offset.map_or(Ok(receipt), |_| Err(Refusal::Late))
    }
}
