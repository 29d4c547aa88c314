//! A ground station on a line: a thread reads the vehicle's frames and sends a heartbeat each second, also while the
//! builder does nothing.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, UdpSocket};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use mavlink_core::{Message, MessageData};
use sophie_dialect::{HEARTBEAT_DATA, MavAutopilot, MavMessage, MavType};
use sophie_mavlink::wire::frame::{COMPONENT, Encoder, Frame, SYSTEM};
use sophie_mavlink::wire::parser::Parser;
use sophie_mavlink::wire::signing::Signing;
use sophie_ports::signing::{Key, Record, Stored};

/// System ID of the station, beside a ground station's usual 255.
pub const STATION: u8 = 254;
/// Component ID of the station (MAV_COMP_ID_MISSIONPLANNER: a ground station).
pub const STATION_COMPONENT: u8 = 190;
/// Time from one heartbeat to the next.
const BEAT: Duration = Duration::from_secs(1);
/// Longest wait for something to be heard.
const SLICE: Duration = Duration::from_millis(20);
/// Start of the signatures' time, 2015-01-01, after Unix's.
const EPOCH: Duration = Duration::from_secs(1_420_070_400);

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

/// A station's memory of received frames.
pub trait Heard: Send + 'static {
    /// Takes a frame of the vehicle.
    fn hear(&mut self, frame: &Frame<'_>);

    /// Takes bytes as they came, before they are read as frames.
    fn came(&mut self, _bytes: &[u8]) {}

    /// Nothing waits for the reader.
    fn is_empty(&self) -> bool;
}

/// A station at work.
pub struct Station<H> {
    output: Box<dyn Write + Send>,
    encoder: Encoder,
    signing: Signing,
    begun: Instant,
    /// Received frames.
    pub heard: H,
    /// Error that ended the line.
    pub ended: Option<ErrorKind>,
    /// The session is over.
    closed: bool,
}

impl<H: Heard> Station<H> {
    fn now(&self) -> u64 {
        self.begun.elapsed().as_micros() as u64
    }

    /// Sends a message.
    ///
    /// # Errors
    /// The line is lost.
    pub fn send<M: MessageData>(&mut self, message: &M) -> io::Result<()> {
        let now = self.now();
        self.encoder.leave_room(self.signing.signs());
        self.encoder.encode(message);
        self.signing.sign(self.encoder.frame_mut(), 0, now);
        self.output.write_all(self.encoder.frame())
    }

    /// Sends bytes that are no frame.
    ///
    /// # Errors
    /// The line is lost.
    pub fn send_raw(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.output.write_all(bytes)
    }

    fn beat(&mut self) -> io::Result<()> {
        self.send(&HEARTBEAT_DATA {
            mavtype: MavType::MAV_TYPE_GCS as u8,
            autopilot: MavAutopilot::MAV_AUTOPILOT_INVALID as u8,
            mavlink_version: 3,
            ..HEARTBEAT_DATA::DEFAULT
        })
    }

    fn hear(&mut self, frame: &Frame<'_>) {
        let now = self.now();
        let vehicle = (frame.system, frame.component) == (SYSTEM, COMPONENT);
        if vehicle && self.signing.takes(frame, now) {
            self.heard.hear(frame);
        }
    }
}

struct Shared<H> {
    station: Mutex<Station<H>>,
    /// Signals a received frame, or the end of the line.
    came: Condvar,
}

/// A station and its thread, which ends with it.
pub struct Line<H: Heard> {
    shared: Arc<Shared<H>>,
    thread: Option<JoinHandle<()>>,
}

impl<H: Heard> Line<H> {
    /// A station on `ends`, signed if `key` is given.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn open(ends: Ends, key: Option<Key>, heard: H) -> io::Result<Self> {
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
                begun: Instant::now(),
                heard,
                ended: None,
                closed: false,
            }),
            came: Condvar::new(),
        });
        let serving = shared.clone();
        let mut input = ends.input;
        let thread = std::thread::Builder::new().spawn(move || serve(&serving, &mut input))?;
        Ok(Self {
            shared,
            thread: Some(thread),
        })
    }

    /// The station.
    pub fn station(&self) -> MutexGuard<'_, Station<H>> {
        locked(&self.shared.station)
    }

    /// The station once something was heard or the line has ended, after 20 ms at most.
    pub fn wait(&self) -> MutexGuard<'_, Station<H>> {
        let waits = |station: &mut Station<H>| station.heard.is_empty() && station.ended.is_none();
        let waited = self.shared.came.wait_timeout_while(self.station(), SLICE, waits);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

impl<H: Heard> Drop for Line<H> {
    fn drop(&mut self) {
        self.station().closed = true;
        let _ = self.thread.take().map(JoinHandle::join);
    }
}

/// Reads until the session is over or the line has ended.
fn serve<H: Heard>(shared: &Shared<H>, input: &mut dyn Read) {
    let mut parser = Parser::reading(extra);
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
                let bytes = bytes.get(..count).unwrap_or_default();
                station.heard.came(bytes);
                for byte in bytes {
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

/// Last byte of a message's checksum, of all that the vehicle sends.
fn extra(id: u32) -> Option<u8> {
    Some(MavMessage::extra_crc(id)).filter(|extra| *extra > 0)
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // The shared state is consistent after each step.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
