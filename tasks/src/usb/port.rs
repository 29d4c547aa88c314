//! Port between the USB device and its two users, console and MAVLink; one of them owns it at a time.

use core::cell::RefCell;

use embassy_sync::blocking_mutex::Mutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Duration, Instant, with_timeout};
use heapless::Vec;
use sophie_mavlink::wire::protocol_detector::{Protocol, ProtocolDetector, Route};

use crate::console::CANCEL;
use crate::links::last_value::Raw;
use sophie_ports::error::PortError;
use sophie_ports::serial::{SerialInput, SerialOutput};

/// Input buffer of each user, bytes: a pasted text, or several frames.
const INPUT: usize = 256;
/// Output buffer, bytes: the longest frame and the longest line.
const OUTPUT: usize = 512;
/// Time-out of a write. The host has half of it to fetch a packet.
const LONGEST_WRITE: Duration = Duration::from_millis(200);
/// Replaces unreadable input, so that the console rejects the line.
const UNREADABLE: u8 = 0x80;

/// Bytes of a packet at full speed.
pub const PACKET: u16 = 64;
/// Bytes of a packet for one user: a received byte may expand to two.
type Sorted = Vec<u8, { 2 * PACKET as usize }>;

/// The port.
pub struct Port {
    state: Mutex<Raw, RefCell<State>>,
    console: Pipe<Raw, INPUT>,
    mavlink: Pipe<Raw, INPUT>,
    output: Pipe<Raw, OUTPUT>,
}

struct State {
    detector: ProtocolDetector,
    /// The bus is suspended or without cable or host.
    suspended: bool,
}

impl Default for Port {
    fn default() -> Self {
        Self::new()
    }
}

impl Port {
    /// An empty port without a host.
    pub const fn new() -> Self {
        Self {
            state: Mutex::new(RefCell::new(State {
                detector: ProtocolDetector::new(),
                suspended: true,
            })),
            console: Pipe::new(),
            mavlink: Pipe::new(),
            output: Pipe::new(),
        }
    }

    /// The console's end.
    pub const fn console(&self) -> (UsbInput<'_>, UsbOutput<'_>) {
        self.end(Protocol::Text)
    }

    /// MAVLink's end.
    pub const fn mavlink(&self) -> (UsbInput<'_>, UsbOutput<'_>) {
        self.end(Protocol::Mavlink)
    }

    const fn end(&self, user: Protocol) -> (UsbInput<'_>, UsbOutput<'_>) {
        (UsbInput { port: self, user }, UsbOutput { port: self, user })
    }

    fn with<R>(&self, work: impl FnOnce(&mut State) -> R) -> Option<R> {
        self.state
            .lock(|state| Some(work(&mut *state.try_borrow_mut().ok()?)))
    }

    /// Notes that the bus was suspended or resumed.
    pub(super) fn suspend(&self, suspended: bool) {
        self.with(|state| state.suspended = suspended);
    }

    /// Returns the port to the console and drops pending output.
    pub(super) fn close(&self) {
        self.with(|state| state.detector.reset());
        self.drop_output();
        // Aborts the console's command. If the buffer is full, its content aborts it.
        let _ = self.console.try_write(&[CANCEL]);
    }

    /// Drops pending output.
    pub(super) fn drop_output(&self) {
        self.output.clear();
    }

    /// The next bytes for the host.
    pub(super) async fn next(&self, chunk: &mut [u8]) -> usize {
        self.output.read(chunk).await
    }

    /// Distributes a packet to its users; waits until they have room.
    pub(super) async fn take(&self, packet: &[u8]) {
        let (mut text, mut frames) = (Sorted::new(), Sorted::new());
        let now = Instant::now().as_micros();
        let other = self.with(|state| state.sort(packet, now, &mut text, &mut frames));
        if other == Some(true) {
            self.drop_output();
        }
        self.console.write_all(&text).await;
        self.mavlink.write_all(&frames).await;
    }

    fn belongs_to(&self, user: Protocol) -> bool {
        self.with(|state| !state.suspended && state.detector.protocol() == user)
            .unwrap_or(false)
    }
}

impl State {
    /// Splits a packet by protocol; true if the port has changed its owner.
    fn sort(&mut self, packet: &[u8], now: u64, text: &mut Sorted, frames: &mut Sorted) -> bool {
        self.suspended = false;
        let first = self.detector.protocol();
        // Never full: `Sorted` holds twice a packet.
        if self.detector.expires(now) {
            let _ = text.push(UNREADABLE);
        }
        for &byte in packet {
            let before = self.detector.protocol();
            let _ = match self.detector.take(byte, now) {
                Route::Console => text.push(byte),
                Route::Unreadable => text.push(UNREADABLE),
                Route::Reclaim => text.push(b'\r'),
                Route::Mavlink => frames.push(byte),
                Route::Neither => Ok(()),
            };
            if before == Protocol::Text && self.detector.protocol() == Protocol::Mavlink {
                let _ = text.push(CANCEL);
            }
        }
        self.detector.protocol() != first
    }
}

/// USB input of one user.
#[derive(Clone, Copy)]
pub struct UsbInput<'a> {
    port: &'a Port,
    user: Protocol,
}

impl SerialInput for UsbInput<'_> {
    async fn read(&mut self, buffer: &mut [u8]) -> Result<usize, PortError> {
        Ok(match self.user {
            Protocol::Text => self.port.console.read(buffer).await,
            Protocol::Mavlink => self.port.mavlink.read(buffer).await,
        })
    }
}

/// USB output of one user.
#[derive(Clone, Copy)]
pub struct UsbOutput<'a> {
    port: &'a Port,
    user: Protocol,
}

impl SerialOutput for UsbOutput<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<(), PortError> {
        let writing = async {
            let mut rest = bytes;
            while let (true, false) = (self.listens(), rest.is_empty()) {
                let taken = self.port.output.write(rest).await;
                rest = rest.get(taken..).unwrap_or_default();
            }
            rest.is_empty()
        };
        match with_timeout(LONGEST_WRITE, writing).await {
            Ok(true) => Ok(()),
            Ok(false) => Err(PortError::Absent),
            Err(_) => Err(PortError::Timeout),
        }
    }

    fn listens(&self) -> bool {
        self.port.belongs_to(self.user)
    }
}
