//! Measurement times of senders with a clock of their own, by MAVLink's TIMESYNC.

use sophie_ports::external_pose::TimeSource;

use super::{INPUTS, Refusal};
use crate::wire::requests::Peer;

/// Period of TIMESYNC requests to a sender, µs.
const PERIOD: u64 = 1_000_000;
/// Longest usable round trip, µs: the offset is known to half of it.
const WAY_MAX: u64 = 100_000;
/// Growth of the shortest known round trip with each request, µs: an older measurement loses weight, so that a drifting
/// clock is followed.
const WAY_GROWTH: u64 = 2_000;
/// Oldest accepted measurement, µs.
pub(super) const AGE_MAX: u64 = 1_000_000;
/// Largest time in the future, µs: the error of an offset.
const AHEAD_MAX: u64 = WAY_MAX / 2;

/// A time of the vehicle's clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Time {
    /// µs since the start.
    pub at: u64,
    /// Its source.
    pub source: TimeSource,
}

/// A time stamp of the sender's clock; 0 stands for "none".
#[derive(Clone, Copy, Debug)]
pub(super) enum Stamp {
    /// µs.
    Micros(u64),
    /// ms modulo 2^32 of a clock of 64 bits: Unix time, or more than 49 days.
    Millis(u32),
}

impl Stamp {
    const fn given(self) -> bool {
        !matches!(self, Self::Micros(0) | Self::Millis(0))
    }

    /// This time by the vehicle's clock, µs. The sender's clock is `offset` ahead of it, and it shows `now`. A short
    /// stamp stands for many times: the one nearest to `now` is taken. A time before the start comes out far in the
    /// future.
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

/// A sender's clock.
#[derive(Clone, Copy, Debug)]
struct Clock {
    of: Peer,
    /// Time of the next request, µs.
    ask_at: u64,
    /// Time of the last request, µs; `None` once it is answered.
    asked_at: Option<u64>,
    /// The sender's time minus the vehicle's, µs, and the round trip of that measurement, µs.
    offset: Option<i64>,
    way: u64,
}

/// The clocks of the senders with accepted inputs, on all lines.
#[derive(Clone, Debug, Default)]
pub struct Clocks {
    /// One for each input. Each input has one source, so a new source always finds the clock of a former one to
    /// replace.
    known: [Option<Clock>; INPUTS],
}

impl Clocks {
    fn of(&mut self, peer: Peer) -> Option<&mut Clock> {
        self.known.iter_mut().flatten().find(|clock| clock.of == peer)
    }

    /// Keeps a clock for `peer`, a sender with an accepted input. It replaces the clock of a sender that is not
    /// `needed`.
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

    /// True if `peer` must be asked at `now`, µs: once a second, if it has a clock here.
    pub(super) fn due(&mut self, peer: Peer, now: u64) -> bool {
        let due = self.of(peer).filter(|clock| now >= clock.ask_at);
        if let Some(clock) = due {
            clock.ask_at = now.saturating_add(PERIOD);
            return true;
        }
        false
    }

    /// Notes a request to `peer` at `now`, µs; false if it has no clock here any more.
    pub(crate) fn ask(&mut self, peer: Peer, now: u64) -> bool {
        let Some(clock) = self.of(peer) else {
            return false;
        };
        clock.asked_at = Some(now);
        clock.way = clock.way.saturating_add(WAY_GROWTH).min(WAY_MAX);
        true
    }

    /// Takes an answer received at `now`, µs: the sender's time `theirs` when it got the request of time `ours`, both
    /// in ns. An answer to another request, or a late one, is ignored.
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
        // Each offset is known to half of its round trip. A difference beyond both comes from a restarted sender with a
        // new clock.
        let other = clock.offset.is_some_and(|known| known.abs_diff(offset) > WAY_MAX);
        if way > clock.way && !other {
            return;
        }
        clock.asked_at = None;
        clock.way = way;
        clock.offset = Some(offset);
    }

    /// Measurement time of a message of `from` with the time stamp `stamp`, received at `now`, µs.
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
        // The known offset goes first: a foreign clock can agree with the vehicle's by chance.
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
