//! Signed frames: with a key, each sent frame carries a signature, and a received frame is obeyed only with a valid
//! one.
//!
//! A signature is 48 bits of SHA-256 over the key, the frame and a time in units of 10 µs since 2015, which grows from
//! frame to frame (mavlink.io/en/guide/message_signing.html). The board has no calendar clock: its time starts at a
//! stored bound and follows the latest validly signed time. The bound lies ahead of every accepted time, so that no
//! frame from before a restart is accepted again.

use sha2::{Digest, Sha256};
use sophie_ports::signing::{Key, Record, Stored};

use crate::wire::frame::{Frame, SIGNATURE};
use mavlink_core::MessageData;
use sophie_dialect::HEARTBEAT_DATA;

/// Length of the hash, the last part of a frame, bytes.
const HASH: usize = 6;
/// Number of senders with a remembered time. A sender that is silent for a minute makes room.
const SENDERS: usize = 6;
/// A minute in units of 10 µs. The time of a new sender may be so much behind.
const MINUTE: u64 = 6_000_000;
/// Distance of the stored bound ahead of the latest time: an hour, so that it is rarely written.
const LEASE: u64 = 60 * MINUTE;
/// The bound is written again when less than this is left: half an hour of flight is covered.
const RENEWAL: u64 = LEASE / 2;
/// Time between two attempts to write the bound, µs.
const RETRY: u64 = 10_000_000;
/// Time between two texts about refused frames, µs.
const REPORT: u64 = 10_000_000;
/// Largest time: 48 bits last until 2104.
const TIME_MAX: u64 = (1 << 48) - 1;

/// Frames that were refused since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refused {
    /// Without a signature.
    pub unsigned: u32,
    /// With a wrong signature.
    pub wrong: u32,
    /// Repeated, too old, or of a sender without a free entry.
    pub old: u32,
}

/// Sender: system, component and link.
type Name = [u8; 3];

/// A sender and the time of its latest frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Sender {
    name: Name,
    /// 0 for a free entry.
    latest: u64,
}

/// The key and the times of accepted and sent frames. All lines share one, so that a frame sent on one line is not
/// accepted on another.
#[derive(Clone, Debug)]
pub struct Signing {
    stored: Stored,
    /// Signing time at the board's start.
    origin: u64,
    /// Frames of this time or before are refused.
    floor: u64,
    /// Latest time of an accepted frame.
    taken: u64,
    /// Latest time of a sent frame.
    sent: u64,
    senders: [Sender; SENDERS],
    refused: Refused,
    reported: Refused,
    /// Earliest times of the next report and of the next write, µs.
    report_at: u64,
    store_at: u64,
}

impl Signing {
    /// The state at the start, given the stored record.
    pub const fn new(stored: Stored) -> Self {
        let bound = match stored {
            Stored::Key(Record { bound, .. }) => bound,
            Stored::None | Stored::Unreadable | Stored::Lost => 0,
        };
        Self {
            stored,
            origin: bound,
            floor: bound,
            taken: 0,
            sent: 0,
            senders: [Sender {
                name: [0; 3],
                latest: 0,
            }; SENDERS],
            refused: Refused {
                unsigned: 0,
                wrong: 0,
                old: 0,
            },
            reported: Refused {
                unsigned: 0,
                wrong: 0,
                old: 0,
            },
            report_at: 0,
            store_at: 0,
        }
    }

    /// The stored key.
    pub const fn stored(&self) -> &Stored {
        &self.stored
    }

    /// Refused frames since the start.
    pub const fn refused(&self) -> Refused {
        self.refused
    }

    /// Reason for refusing all frames; empty while frames are accepted.
    pub const fn notice(&self) -> &'static str {
        match self.stored {
            Stored::None | Stored::Key(_) => "",
            Stored::Unreadable => "signing key not known: storage unreadable",
            Stored::Lost => "signing key lost: set it at the console, or off",
        }
    }

    /// True if sent frames are signed.
    pub const fn signs(&self) -> bool {
        matches!(self.stored, Stored::Key(_))
    }

    /// The signing time at `now`, µs since the start.
    fn time(&self, now: u64) -> u64 {
        self.origin.saturating_add(now / 10).min(TIME_MAX)
    }

    /// True if `frame`, received at `now`, may be obeyed. Without a signature only heartbeats may, as in PX4: they
    /// change nothing.
    pub fn takes(&mut self, frame: &Frame<'_>, now: u64) -> bool {
        if self.stored == Stored::None {
            return true;
        }
        let Some(signed) = Signed::of(frame) else {
            let harmless = frame.id == HEARTBEAT_DATA::ID;
            count(&mut self.refused.unsigned, !harmless);
            return harmless;
        };
        let Stored::Key(Record { key, .. }) = self.stored else {
            count(&mut self.refused.wrong, true);
            return false;
        };
        let time = self.time(now);
        let Some(sender) = sender(&mut self.senders, &signed, self.floor, time) else {
            // Tested before the hash, which takes longer than all else.
            count(&mut self.refused.old, true);
            return false;
        };
        if !same(&hash(&key, signed.bytes), signed.hash) {
            count(&mut self.refused.wrong, true);
            return false;
        }
        *sender = Sender {
            name: signed.name,
            latest: signed.time,
        };
        self.taken = self.taken.max(signed.time);
        self.origin = self.origin.max(signed.time.saturating_sub(now / 10));
        true
    }

    /// Signs `frame` at `now`, µs, as number `link` of this vehicle's lines. The frame's last 13 bytes are free for the
    /// signature.
    pub fn sign(&mut self, frame: &mut [u8], link: u8, now: u64) {
        let Stored::Key(Record { key, .. }) = self.stored else {
            return;
        };
        self.sent = self.time(now).max(self.sent.saturating_add(1)).min(TIME_MAX);
        let Some((bytes, last)) = frame.split_last_chunk_mut::<HASH>() else {
            return;
        };
        if let Some((_, head)) = bytes.split_last_chunk_mut::<{ SIGNATURE - HASH }>() {
            let [a, b, c, d, e, f, ..] = self.sent.to_le_bytes();
            *head = [link, a, b, c, d, e, f];
        }
        *last = hash(&key, bytes);
    }

    /// The record that must be stored at `now`, µs since the start; the board must be at rest.
    pub fn to_store(&mut self, now: u64) -> Option<Record> {
        let Stored::Key(Record { key, bound }) = self.stored else {
            return None;
        };
        if self.taken.saturating_add(RENEWAL) <= bound
            || bound == TIME_MAX
            || self.taken == 0
            || now < self.store_at
        {
            return None;
        }
        self.store_at = now.saturating_add(RETRY);
        Some(Record {
            key,
            bound: self.taken.saturating_add(LEASE).min(TIME_MAX),
        })
    }

    /// Notes that `record` has been stored.
    pub const fn keep(&mut self, record: Record) {
        self.stored = Stored::Key(record);
    }

    /// The refused frames since the start, if more than last reported, at most once each `REPORT`; `now` in µs since
    /// the start.
    pub fn report(&mut self, now: u64) -> Option<Refused> {
        if self.refused == self.reported || now < self.report_at {
            return None;
        }
        self.report_at = now.saturating_add(REPORT);
        self.reported = self.refused;
        Some(self.refused)
    }
}

/// A frame with a signature.
struct Signed<'a> {
    name: Name,
    time: u64,
    /// The bytes that are hashed after the key.
    bytes: &'a [u8],
    hash: &'a [u8; HASH],
}

impl<'a> Signed<'a> {
    fn of(frame: &Frame<'a>) -> Option<Self> {
        if !frame.signed {
            return None;
        }
        let (bytes, hash) = frame.bytes.split_last_chunk::<HASH>()?;
        let (_, &[link, a, b, c, d, e, f]) = bytes.split_last_chunk::<{ SIGNATURE - HASH }>()?;
        Some(Self {
            name: [frame.system, frame.component, link],
            time: u64::from_le_bytes([a, b, c, d, e, f, 0, 0]),
            bytes,
            hash,
        })
    }
}

/// The entry of `signed`'s sender; `None` if its time is too old at `now`, or all entries are taken.
fn sender<'s>(
    senders: &'s mut [Sender; SENDERS],
    signed: &Signed<'_>,
    floor: u64,
    now: u64,
) -> Option<&'s mut Sender> {
    if signed.time <= floor {
        return None;
    }
    let known = (senders.iter()).position(|sender| sender.latest > 0 && sender.name == signed.name);
    let at = match known {
        Some(at) => at,
        None if signed.time.saturating_add(MINUTE) < now => return None,
        // The times of an expired sender are too old for a new one as well: its entry can be reused.
        None => (senders.iter()).position(|s| s.latest == 0 || s.latest.saturating_add(MINUTE) < now)?,
    };
    let sender = senders.get_mut(at)?;
    (known.is_none() || signed.time > sender.latest).then_some(sender)
}

fn hash(key: &Key, bytes: &[u8]) -> [u8; HASH] {
    let mut sha = Sha256::new();
    sha.update(key.bytes());
    sha.update(bytes);
    let [a, b, c, d, e, f, ..] = <[u8; 32]>::from(sha.finalize());
    [a, b, c, d, e, f]
}

/// Compares in constant time.
fn same(a: &[u8; HASH], b: &[u8; HASH]) -> bool {
    let difference = a.iter().zip(b).fold(0, |all, (a, b)| all | (a ^ b));
    core::hint::black_box(difference) == 0
}

fn count(counter: &mut u32, more: bool) {
    *counter = counter.saturating_add(more.into());
}
