//! The console over MAVLink: `SERIAL_CONTROL`'s shell, one station at a time. The bytes are the console's, as on a cable.

use heapless::Vec;

use crate::wire::requests::Peer;
use sophie_dialect::{SERIAL_CONTROL_DATA, SerialControlDev, SerialControlFlag};

/// Bytes of one message.
pub const CHUNK: usize = 70;
/// Bytes that wait for the console at most: two messages and a [`HANG_UP`]. What does not fit is lost, as on a cable.
pub const TYPED: usize = 2 * CHUNK + 1;
/// Silence of a station after which its console is ended, µs: a minute of its heartbeats. What turns ends by itself within
/// seconds; a live flight may run at many times the pace of its stations.
const SILENCE: u64 = 60_000_000;
/// Ctrl-C: ends what runs at the console and drops what is typed there so far. Alone it takes no console over from another
/// terminal.
pub const HANG_UP: u8 = 0x03;

/// The far end of the console.
#[derive(Debug, Default)]
pub struct Shell {
    /// Who uses it.
    user: Option<Peer>,
    /// When something came from there last, µs.
    heard_at: u64,
    typed: Vec<u8, TYPED>,
    said: Vec<u8, CHUNK>,
    /// Messages so far: who reads them sees what was lost.
    count: u16,
    /// A stream has gone out since its last frame: the next one is the console's, where there is one.
    pub(crate) waits: bool,
}

impl Shell {
    pub(crate) const fn new() -> Self {
        Self {
            user: None,
            heard_at: 0,
            typed: Vec::new(),
            said: Vec::new(),
            count: 0,
            waits: false,
        }
    }

    /// Takes a message. A station that types takes the console from another, whose command ends.
    pub(crate) fn obey(&mut self, serial: &SERIAL_CONTROL_DATA, from: Peer, now: u64) {
        let flags = SerialControlFlag::from_bits_truncate(serial.flags.into());
        let shell = serial.device == SerialControlDev::SERIAL_CONTROL_DEV_SHELL as u8;
        if !shell || flags.contains(SerialControlFlag::SERIAL_CONTROL_FLAG_REPLY) {
            return;
        }
        if self.user != Some(from) {
            self.hang_up();
            self.user = Some(from);
        }
        self.heard_at = now;
        let count = usize::from(serial.count).min(CHUNK);
        for byte in serial.data.iter().take(count) {
            if self.typed.len() + 1 < TYPED {
                let _ = self.typed.push(*byte);
            }
        }
        // Who wants no answer uses it no longer, as PX4 has it.
        if !flags.contains(SerialControlFlag::SERIAL_CONTROL_FLAG_RESPOND) {
            self.hang_up();
        }
    }

    /// A heartbeat of `from` has come.
    pub(crate) fn hear(&mut self, from: Peer, now: u64) {
        if self.user == Some(from) {
            self.heard_at = now;
        }
    }

    /// Ends the console of a station that has gone.
    pub(crate) fn expire(&mut self, now: u64) {
        if now.saturating_sub(self.heard_at) > SILENCE {
            self.hang_up();
        }
    }

    /// Ends the console of whoever uses it, if any.
    pub fn hang_up(&mut self) {
        if self.user.take().is_some() {
            self.said.clear();
            self.typed.truncate(TYPED - 1);
            let _ = self.typed.push(HANG_UP);
        }
    }

    /// What has been typed since the last call.
    pub fn typed(&mut self) -> Vec<u8, TYPED> {
        core::mem::take(&mut self.typed)
    }

    /// True where a station uses it.
    pub const fn used(&self) -> bool {
        self.user.is_some()
    }

    /// True where it takes what the console says next.
    pub fn takes(&self) -> bool {
        self.used() && self.said.is_empty()
    }

    /// Takes what the console says, [`CHUNK`] bytes at most, where [`Self::takes`] is true.
    pub fn say(&mut self, bytes: &[u8]) {
        if self.takes() {
            let _ = self.said.extend_from_slice(bytes);
        }
    }

    /// What was said, as a message.
    pub(crate) fn said(&mut self) -> Option<SERIAL_CONTROL_DATA> {
        let user = self.user?;
        if self.said.is_empty() {
            return None;
        }
        let mut data = [0; CHUNK];
        for (to, from) in data.iter_mut().zip(&self.said) {
            *to = *from;
        }
        let count = self.said.len() as u8;
        self.said.clear();
        self.count = self.count.wrapping_add(1);
        Some(SERIAL_CONTROL_DATA {
            baudrate: 0,
            // Of no use in an answer to the standard.
            timeout: self.count,
            device: SerialControlDev::SERIAL_CONTROL_DEV_SHELL as u8,
            flags: SerialControlFlag::SERIAL_CONTROL_FLAG_REPLY.bits() as u8,
            count,
            data,
            target_system: user.system,
            target_component: user.component,
        })
    }
}
