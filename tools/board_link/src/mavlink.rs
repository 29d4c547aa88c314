//! A console over MAVLink: `SERIAL_CONTROL`'s shell as a [`Wire`].

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};

use mavlink_core::{MavlinkVersion, MessageData};
use sophie_dialect::{SERIAL_CONTROL_DATA, SerialControlDev, SerialControlFlag};
use sophie_mavlink::services::shell::CHUNK;
use sophie_mavlink::wire::frame::{COMPONENT, Frame, SYSTEM};
use sophie_ports::signing::Key;

use crate::station::{Ends, Heard, Line, STATION, STATION_COMPONENT, Station};
use crate::wire::Wire;

/// Largest number of bytes kept for a reader: more than the longest list.
const KEPT: usize = 1 << 18;
/// Stands for lost bytes: a line with it counts as damaged.
const LOST: u8 = 0x80;

/// The console over `ends`, signed if `key` is given.
///
/// # Errors
/// The thread cannot be started.
pub fn open(ends: Ends, key: Option<Key>) -> io::Result<Box<dyn Wire>> {
    Ok(Box::new(Shell(Line::open(ends, key, Said::default())?)))
}

/// Output of the console.
#[derive(Default)]
struct Said {
    bytes: VecDeque<u8>,
    /// Number of its latest message.
    count: Option<u16>,
}

impl Heard for Said {
    fn hear(&mut self, frame: &Frame<'_>) {
        if frame.id != SERIAL_CONTROL_DATA::ID {
            return;
        }
        let Ok(said) = SERIAL_CONTROL_DATA::deser(MavlinkVersion::V2, frame.payload) else {
            return;
        };
        let reply = u16::from(said.flags) & SerialControlFlag::SERIAL_CONTROL_FLAG_REPLY.bits() != 0;
        let here = (said.target_system, said.target_component) == (STATION, STATION_COMPONENT);
        if !reply || !here || self.count == Some(said.timeout) || self.bytes.len() > KEPT {
            return;
        }
        if self
            .count
            .is_some_and(|count| said.timeout != count.wrapping_add(1))
        {
            self.bytes.push_back(LOST);
        }
        self.count = Some(said.timeout);
        let count = usize::from(said.count).min(CHUNK);
        self.bytes.extend(said.data.iter().take(count));
    }

    fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

/// The session's end.
struct Shell(Line<Said>);

/// Types `bytes`, at most [`CHUNK`]; no bytes end the console session.
fn type_in(station: &mut Station<Said>, bytes: &[u8]) -> io::Result<()> {
    let mut data = [0; CHUNK];
    data.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
    let flags = if bytes.is_empty() {
        SerialControlFlag::empty()
    } else {
        SerialControlFlag::SERIAL_CONTROL_FLAG_RESPOND | SerialControlFlag::SERIAL_CONTROL_FLAG_EXCLUSIVE
    };
    station.send(&SERIAL_CONTROL_DATA {
        device: SerialControlDev::SERIAL_CONTROL_DEV_SHELL as u8,
        flags: flags.bits() as u8,
        count: bytes.len().min(CHUNK) as u8,
        data,
        target_system: SYSTEM,
        target_component: COMPONENT,
        ..SERIAL_CONTROL_DATA::DEFAULT
    })
}

impl Read for Shell {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut station = self.0.wait();
        if station.heard.is_empty() {
            return match station.ended {
                None => Err(ErrorKind::TimedOut.into()),
                Some(ErrorKind::UnexpectedEof) => Ok(0),
                Some(other) => Err(other.into()),
            };
        }
        station.heard.bytes.read(buffer)
    }
}

impl Write for Shell {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = bytes.len().min(CHUNK);
        if count > 0 {
            type_in(&mut self.0.station(), &bytes[..count])?;
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Shell {
    fn drop(&mut self) {
        // If this frame is lost, the vehicle notices the silence.
        let _ = type_in(&mut self.0.station(), &[]);
    }
}
