//! A console over MAVLink: `SERIAL_CONTROL`'s shell as a [`Wire`], with a station ID of its own.
//!
//! A thread reads the vehicle's frames and sends a heartbeat each second, also while the builder does nothing: the
//! vehicle ends the console session of a silent station.

use std::collections::VecDeque;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use mavlink_core::{MavlinkVersion, MessageData};
use sophie_dialect::{
    HEARTBEAT_DATA, MavAutopilot, MavType, SERIAL_CONTROL_DATA, SerialControlDev, SerialControlFlag,
};
use sophie_mavlink::services::shell::CHUNK;
use sophie_mavlink::wire::frame::{COMPONENT, Encoder, Frame, SYSTEM};
use sophie_mavlink::wire::parser::Parser;
use sophie_mavlink::wire::signing::Signing;
use sophie_ports::signing::{Key, Record, Stored};

use crate::wire::Wire;

/// System ID of the station, beside a ground station's usual 255.
const STATION: u8 = 254;
/// Component ID of the station (MAV_COMP_ID_MISSIONPLANNER: a ground station).
const STATION_COMPONENT: u8 = 190;
/// Time from one heartbeat to the next.
const BEAT: Duration = Duration::from_secs(1);
/// Longest wait of a read.
const SLICE: Duration = Duration::from_millis(20);
/// Largest number of bytes kept for a reader: more than the longest list.
const KEPT: usize = 1 << 18;
/// Start of the signatures' time, 2015-01-01, after Unix's.
const EPOCH: Duration = Duration::from_secs(1_420_070_400);
/// Stands for lost bytes: a line with it counts as damaged.
const LOST: u8 = 0x80;

/// Both ends of the line that carries MAVLink. A read of a silent line returns within some milliseconds.
pub struct Ends {
    /// Source of received bytes.
    pub input: Box<dyn Read + Send>,
    /// Sink of sent bytes; each write is one frame.
    pub output: Box<dyn Write + Send>,
}

/// Datagrams from and to a vehicle. Without a given address they go to the latest sender.
///
/// # Errors
/// The socket cannot be shared.
pub fn udp(socket: UdpSocket, to: Option<SocketAddr>) -> io::Result<Ends> {
    let peer = Arc::new(Mutex::new(to));
    let half = |socket| Datagrams {
        socket,
        peer: peer.clone(),
        fixed: to.is_some(),
    };
    Ok(Ends {
        input: Box::new(half(socket.try_clone()?)),
        output: Box::new(half(socket)),
    })
}

struct Datagrams {
    socket: UdpSocket,
    peer: Arc<Mutex<Option<SocketAddr>>>,
    /// The address was given and does not change.
    fixed: bool,
}

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let (count, from) = match self.socket.recv_from(buffer) {
            // No socket listens there yet.
            Err(error) if error.kind() == ErrorKind::ConnectionRefused => {
                return Err(ErrorKind::WouldBlock.into());
            }
            other => other?,
        };
        if !self.fixed {
            *locked(&self.peer) = Some(from);
        }
        Ok(count)
    }
}

impl Write for Datagrams {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let to = *locked(&self.peer);
        if let Some(to) = to
            && let Err(error) = self.socket.send_to(bytes, to)
            && error.kind() != ErrorKind::ConnectionRefused
        {
            return Err(error);
        }
        // Without an address of the vehicle the datagram is dropped.
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// The console over `ends`, signed if `key` is given.
///
/// # Errors
/// The thread cannot be started.
pub fn open(ends: Ends, key: Option<Key>) -> io::Result<Box<dyn Wire>> {
    let begun = Instant::now();
    let date = SystemTime::now().duration_since(UNIX_EPOCH + EPOCH);
    let stored = key.map_or(Stored::None, |key| {
        let bound = date.map_or(0, |date| date.as_micros() as u64 / 10);
        Stored::Key(Record { key, bound })
    });
    let shared = Arc::new(Shared {
        station: Mutex::new(Station {
            output: ends.output,
            encoder: Encoder::of(STATION, STATION_COMPONENT),
            signing: Signing::new(stored),
            begun,
            heard: VecDeque::new(),
            count: None,
            ended: None,
            closed: false,
        }),
        came: Condvar::new(),
    });
    let serving = shared.clone();
    let mut input = ends.input;
    let thread = std::thread::Builder::new().spawn(move || serve(&serving, &mut input))?;
    Ok(Box::new(Shell {
        shared,
        thread: Some(thread),
    }))
}

struct Shared {
    station: Mutex<Station>,
    /// Signals new output or the end of the line.
    came: Condvar,
}

struct Station {
    output: Box<dyn Write + Send>,
    encoder: Encoder,
    signing: Signing,
    begun: Instant,
    /// Output of the console.
    heard: VecDeque<u8>,
    /// Number of its latest message.
    count: Option<u16>,
    /// Error that ended the line.
    ended: Option<ErrorKind>,
    /// The session is over.
    closed: bool,
}

impl Station {
    fn now(&self) -> u64 {
        self.begun.elapsed().as_micros() as u64
    }

    fn send<M: MessageData>(&mut self, message: &M) -> io::Result<()> {
        let now = self.now();
        self.encoder.leave_room(self.signing.signs());
        self.encoder.encode(message);
        self.signing.sign(self.encoder.frame_mut(), 0, now);
        self.output.write_all(self.encoder.frame())
    }

    fn beat(&mut self) -> io::Result<()> {
        self.send(&HEARTBEAT_DATA {
            mavtype: MavType::MAV_TYPE_GCS as u8,
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID as u8,
            mavlink_version: 3,
            ..HEARTBEAT_DATA::DEFAULT
        })
    }

    /// Types `bytes`, at most [`CHUNK`]; no bytes end the console session.
    fn type_in(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut data = [0; CHUNK];
        data.iter_mut().zip(bytes).for_each(|(to, from)| *to = *from);
        let flags = if bytes.is_empty() {
            SerialControlFlag::empty()
        } else {
            SerialControlFlag::SERIAL_CONTROL_FLAG_RESPOND | SerialControlFlag::SERIAL_CONTROL_FLAG_EXCLUSIVE
        };
        self.send(&SERIAL_CONTROL_DATA {
            device: SerialControlDev::SERIAL_CONTROL_DEV_SHELL as u8,
            flags: flags.bits() as u8,
            count: bytes.len().min(CHUNK) as u8,
            data,
            target_system: SYSTEM,
            target_component: COMPONENT,
            ..SERIAL_CONTROL_DATA::DEFAULT
        })
    }

    /// Takes a frame of the vehicle.
    fn hear(&mut self, frame: &Frame<'_>) {
        let now = self.now();
        let vehicle = (frame.system, frame.component) == (SYSTEM, COMPONENT);
        if !vehicle || !self.signing.takes(frame, now) || frame.id != SERIAL_CONTROL_DATA::ID {
            return;
        }
        let Ok(said) = SERIAL_CONTROL_DATA::deser(MavlinkVersion::V2, frame.payload) else {
            return;
        };
        let reply = u16::from(said.flags) & SerialControlFlag::SERIAL_CONTROL_FLAG_REPLY.bits() != 0;
        let here = (said.target_system, said.target_component) == (STATION, STATION_COMPONENT);
        if !reply || !here || self.count == Some(said.timeout) || self.heard.len() > KEPT {
            return;
        }
        if self
            .count
            .is_some_and(|count| said.timeout != count.wrapping_add(1))
        {
            self.heard.push_back(LOST);
        }
        self.count = Some(said.timeout);
        let count = usize::from(said.count).min(CHUNK);
        self.heard.extend(said.data.iter().take(count));
    }
}

/// Reads until the session is over or the line has ended.
fn serve(shared: &Shared, input: &mut dyn Read) {
    let mut parser = Parser::new();
    let mut bytes = [0; 2048];
    let mut beaten: Option<Instant> = None;
    loop {
        let read = input.read(&mut bytes);
        let mut station = locked(&shared.station);
        if station.closed {
            return;
        }
        let ended = match read {
            Ok(0) => Some(ErrorKind::UnexpectedEof),
            Ok(count) => {
                let now = station.now();
                for byte in bytes.iter().take(count) {
                    if let Some(frame) = parser.push(*byte, now) {
                        station.hear(&frame);
                    }
                }
                None
            }
            Err(error) => match error.kind() {
                ErrorKind::TimedOut | ErrorKind::WouldBlock | ErrorKind::Interrupted => None,
                other => Some(other),
            },
        };
        let ended = ended.or_else(|| {
            if beaten.is_some_and(|at| at.elapsed() < BEAT) {
                return None;
            }
            beaten = Some(Instant::now());
            station.beat().err().map(|error| error.kind())
        });
        station.ended = ended;
        if ended.is_some() || !station.heard.is_empty() {
            shared.came.notify_all();
        }
        if ended.is_some() {
            return;
        }
    }
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // The shared state is consistent after each step.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The session's end.
struct Shell {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Read for Shell {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let station = locked(&self.shared.station);
        let waits = |station: &mut Station| station.heard.is_empty() && station.ended.is_none();
        let waited = self.shared.came.wait_timeout_while(station, SLICE, waits);
        let (mut station, _) = waited.unwrap_or_else(PoisonError::into_inner);
        if station.heard.is_empty() {
            return match station.ended {
                None => Err(ErrorKind::TimedOut.into()),
                Some(ErrorKind::UnexpectedEof) => Ok(0),
                Some(other) => Err(other.into()),
            };
        }
        station.heard.read(buffer)
    }
}

impl Write for Shell {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = bytes.len().min(CHUNK);
        if count > 0 {
            locked(&self.shared.station).type_in(&bytes[..count])?;
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Shell {
    fn drop(&mut self) {
        {
            let mut station = locked(&self.shared.station);
            // If this frame is lost, the vehicle notices the silence.
            let _ = station.type_in(&[]);
            station.closed = true;
        }
        let _ = self.thread.take().map(JoinHandle::join);
    }
}
