//! A flight at the pace of real time, with MAVLink on a UDP socket.

mod pace;
mod udp;

use std::cell::Cell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub use self::pace::Pace;
pub use self::udp::Udp;
use crate::clock::VirtualTime;
use crate::devices::chip::ThisChip;
use crate::devices::line::Line;
use crate::devices::mavlink_server;
use crate::devices::storage::{Memory, Port};
use sophie_control::params::Params;
pub use sophie_ports::signing::Key;
use sophie_ports::signing::Record;
use sophie_tasks::console;
use sophie_tasks::links::Links;

/// Reason in the report of a flight that the user stopped.
const STOPPED: &str = "stopped from outside";
/// Output limit of the server, bytes per second of flight; any wired network carries it.
const BYTES_PER_SECOND: u32 = 50_000;

/// The real time and the MAVLink clients of a flight.
pub struct Live {
    pace: Pace,
    udp: Udp,
    line: &'static Line,
    /// The key that signs MAVLink from the first start on.
    key: Option<Key>,
    /// Parameters and key that the next start of the board loads.
    stored: Option<&'static Memory>,
    stop: Arc<AtomicBool>,
    notice: fn(&str),
}

impl Live {
    /// Paced by `pace` with clients at `udp`, until `stop` is set. `notice` receives messages for the user, one line
    /// each.
    ///
    /// The line is leaked: tasks borrow it as `'static`, like the board.
    #[must_use]
    pub fn new(pace: Pace, udp: Udp, stop: Arc<AtomicBool>, notice: fn(&str)) -> Self {
        Self {
            pace,
            udp,
            line: Box::leak(Box::new(Line::new())),
            key: None,
            stored: None,
            stop,
            notice,
        }
    }

    /// The same with MAVLink signed by `key`.
    #[must_use]
    pub fn with_key(self, key: Option<Key>) -> Self {
        Self { key, ..self }
    }

    /// Spawns the board's server and the console over it. The first start stores `links`' parameters.
    pub(crate) fn spawn(&mut self, time: &VirtualTime, links: &'static Links) {
        let key = self.key;
        let stored = *self.stored.get_or_insert_with(|| {
            Box::leak(Box::new(Memory {
                params: Cell::new(links.params),
                signing: Cell::new(key.map(Record::fresh)),
            }))
        });
        let line = self.line;
        let shell = mavlink_server::spawn(time, links, line, BYTES_PER_SECOND, stored, ThisChip(line));
        let chip = ThisChip(line);
        time.spawn(console::run(
            links,
            shell.port(),
            shell.port(),
            Port(stored),
            chip,
        ));
    }

    /// The board's line, for senders besides the clients.
    pub(crate) fn line(&self) -> &'static Line {
        self.line
    }

    /// The parameters of the next start, if a client has ordered a restart.
    pub(crate) fn restarts(&self) -> Option<Params> {
        self.stored
            .filter(|_| self.line.restarts())
            .map(|memory| memory.params.get())
    }

    /// Discards the bytes on the line, as a reset of the board does.
    pub(crate) fn reset(&self) {
        self.line.clear();
    }

    /// Waits until `us` of virtual time is due, and passes the clients' datagrams to the board.
    ///
    /// # Errors
    /// The flight is to stop.
    pub(crate) fn begin(&mut self, us: u64) -> Result<(), String> {
        if let Some(slow) = self.pace.wait(us) {
            (self.notice)(&slow);
        }
        if self.stop.load(Ordering::Relaxed) {
            return Err(STOPPED.to_owned());
        }
        let line = self.line;
        self.udp.receive(|datagram| line.receive(datagram));
        Ok(())
    }

    /// Sends the board's output to the clients.
    pub(crate) fn end(&mut self) {
        while let Some(frame) = self.line.take_write() {
            if let Some(refused) = self.udp.send(&frame) {
                (self.notice)(&refused);
            }
        }
    }
}
