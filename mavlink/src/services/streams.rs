//! Streams: messages that are sent periodically. A ground station can change a period.
//!
//! A stream without budget loses its turn: nothing is queued.

use mavlink_core::MessageData;

use crate::wire::frame::OVERHEAD;
use sophie_dialect::*;

/// A periodic message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stream {
    /// Number of the message.
    pub id: u32,
    /// Its name.
    pub name: &'static str,
    /// Default time between two of them, ms; 0 for a message that is sent on request alone.
    pub period_ms: u32,
    /// Length of its frame at most, bytes.
    pub bytes: u32,
}

/// Length of a message's frame without trimmed zeros, bytes.
pub const fn frame_bytes<M: MessageData>() -> u32 {
    (M::ENCODED_LEN + OVERHEAD) as u32
}

macro_rules! streams {
    ($($message:ident each $period:literal ms;)*) => {
        /// Every stream, the most urgent first.
        pub static STREAMS: [Stream; [$($period),*].len()] = [$(Stream {
            id: $message::ID,
            name: $message::NAME,
            period_ms: $period,
            bytes: frame_bytes::<$message>(),
        }),*];
    };
}

streams! {
    HEARTBEAT_DATA each 1000 ms;
    SYS_STATUS_DATA each 1000 ms;
    EXTENDED_SYS_STATE_DATA each 1000 ms;
    CURRENT_MODE_DATA each 2000 ms;
    ATTITUDE_DATA each 100 ms;
    ATTITUDE_QUATERNION_DATA each 100 ms;
    SOPHIE_ARMS_DATA each 250 ms;
    RC_CHANNELS_DATA each 500 ms;
    SERVO_OUTPUT_RAW_DATA each 500 ms;
    BATTERY_STATUS_DATA each 1000 ms;
    SCALED_IMU_DATA each 200 ms;
    VIBRATION_DATA each 1000 ms;
    SCALED_PRESSURE_DATA each 0 ms;
}

/// Number of streams.
pub const COUNT: usize = STREAMS.len();
/// Shortest period, µs: that of the task which serves the line.
pub const PERIOD_MIN_US: u32 = 20_000;

/// When each stream is due.
#[derive(Clone, Debug)]
pub struct Schedule {
    turns: [Turn; COUNT],
}

/// One stream.
#[derive(Clone, Copy, Debug)]
struct Turn {
    /// Time between two, µs; 0: never.
    period: u32,
    /// When the next one is due, µs.
    due: u64,
}

impl Turn {
    const fn is_due(&self, now: u64) -> bool {
        self.period > 0 && self.due <= now
    }

    /// Sets the next turn; missed turns are left out.
    fn pass(&mut self, now: u64) {
        let period = u64::from(self.period);
        let next = self.due.saturating_add(period);
        self.due = if next > now {
            next
        } else {
            now.saturating_add(period)
        };
    }
}

impl Default for Schedule {
    fn default() -> Self {
        Self::new()
    }
}

impl Schedule {
    /// Every stream at its own period, all due.
    pub const fn new() -> Self {
        let mut turns = [Turn { period: 0, due: 0 }; COUNT];
        let mut at = 0;
        while at < COUNT {
            #[allow(clippy::indexing_slicing, reason = "checked while compiling")]
            {
                turns[at].period = STREAMS[at].period_ms * 1000;
            }
            at += 1;
        }
        Self { turns }
    }

    /// The stream that has been due for longest at `now`, µs, heartbeats excepted; sets its next turn.
    pub fn next(&mut self, now: u64) -> Option<&'static Stream> {
        let (stream, turn) = (STREAMS.iter().zip(&mut self.turns))
            .filter(|(stream, turn)| stream.id != HEARTBEAT_DATA::ID && turn.is_due(now))
            .min_by_key(|(_, turn)| turn.due)?;
        turn.pass(now);
        Some(stream)
    }

    /// True if `id` is due at `now`, µs; sets its next turn then.
    pub fn take(&mut self, id: u32, now: u64) -> bool {
        match self.turn(id) {
            Some(turn) if turn.is_due(now) => {
                turn.pass(now);
                true
            }
            _ => false,
        }
    }

    /// Makes `id` due now.
    pub fn hurry(&mut self, id: u32) {
        if let Some(turn) = self.turn(id) {
            turn.due = 0;
        }
    }

    fn turn(&mut self, id: u32) -> Option<&mut Turn> {
        let at = STREAMS.iter().position(|stream| stream.id == id)?;
        self.turns.get_mut(at)
    }

    /// The period of stream `id`, µs; 0 if it is off, `None` if `id` is not a stream.
    pub fn period(&mut self, id: u32) -> Option<u32> {
        self.turn(id).map(|turn| turn.period)
    }

    /// Sends `id` each `period` µs from `now` on; a period of 0 turns it off. `None` if `id` is not a stream.
    pub fn set_period(&mut self, id: u32, period: u32, now: u64) -> Option<()> {
        let turn = self.turn(id)?;
        *turn = Turn { period, due: now };
        Some(())
    }
}
