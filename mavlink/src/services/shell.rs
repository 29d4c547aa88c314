//! The console over MAVLink: `SERIAL_CONTROL`'s shell, for one station at a time. The bytes are those of the console on
//! a cable.

use heapless::Vec;

use crate::wire::requests::Peer;
use sophie_dialect::{SERIAL_CONTROL_DATA, SerialControlDev, SerialControlFlag};

/// Bytes of one message.
pub const CHUNK: usize = 70;
/// Largest number of bytes that wait for the console: two messages and a [`HANG_UP`]. Further ones are lost, as on a
/// cable.
pub const TYPED: usize = 2 * CHUNK + 1;
/// Silence of a station after which its console session ends, µs: a minute of its heartbeats. A motor test ends within
/// seconds without it; a live flight may run at many times the pace of its stations.
const SILENCE: u64 = 60_000_000;
/// Ctrl-C: ends the running command and drops an unfinished line. Alone it does not take the console from another
/// terminal.
pub const HANG_UP: u8 = 0x03;

/// The station's end of the console.
#[derive(Debug, Default)]
pub struct Shell {
    /// The station that uses it.
    user: Option<Peer>,
    /// Time of its newest message or heartbeat, µs.
    heard_at: u64,
    typed: Vec<u8, TYPED>,
    said: Vec<u8, CHUNK>,
    /// A stream was sent after the console's last frame: the console has the next turn.
    pub(crate) waits: bool,
}

impl Shell {
    pub(crate) const fn new() -> Self {
        Self {
            user: None,
            heard_at: 0,
            typed: Vec::new(),
            said: Vec::new(),
            waits: false,
        }
    }

    /// Takes a message. A station that types takes the console from another, whose command is ended.
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
        // A station that asks for no response releases the console, as in PX4.
        if !flags.contains(SerialControlFlag::SERIAL_CONTROL_FLAG_RESPOND) {
            self.hang_up();
        }
    }

    /// Notes a heartbeat of `from`.
    pub(crate) fn hear(&mut self, from: Peer, now: u64) {
        if self.user == Some(from) {
            self.heard_at = now;
        }
    }

    /// Ends the console session of a silent station.
    pub(crate) fn expire(&mut self, now: u64) {
        if now.saturating_sub(self.heard_at) > SILENCE {
            self.hang_up();
        }
    }

    /// Ends the console session, if a station has one.
    pub fn hang_up(&mut self) {
        if self.user.take().is_some() {
            self.said.clear();
            self.typed.truncate(TYPED - 1);
            let _ = self.typed.push(HANG_UP);
        }
    }

    /// The bytes typed since the last call.
    pub fn typed(&mut self) -> Vec<u8, TYPED> {
        core::mem::take(&mut self.typed)
    }

    /// True while a station uses the console.
    pub const fn used(&self) -> bool {
        self.user.is_some()
    }

    /// True if the shell has room for console output.
    pub fn takes(&self) -> bool {
        self.used() && self.said.is_empty()
    }

    /// Takes console output, at most [`CHUNK`] bytes, if [`Self::takes`] is true.
    pub fn say(&mut self, bytes: &[u8]) {
        if self.takes() {
            let _ = self.said.extend_from_slice(bytes);
        }
    }

    /// The waiting output as a message; `None` without a user or output.
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
        Some(SERIAL_CONTROL_DATA {
            baudrate: 0,
            timeout: 0,
            device: SerialControlDev::SERIAL_CONTROL_DEV_SHELL as u8,
            flags: SerialControlFlag::SERIAL_CONTROL_FLAG_REPLY.bits() as u8,
            count,
            data,
            target_system: user.system,
            target_component: user.component,
        })
    }
}
