//! The far end of the line: a socket, or a pseudo-terminal that is a serial port to whoever opens it.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::time::Duration;

use serial2::SerialPort;

/// Longest wait of one look at a pseudo-terminal, and for room in it.
const LOOK: Duration = Duration::from_millis(1);
const ROOM: Duration = Duration::from_millis(100);

/// One user at a time, the latest.
pub struct Wire {
    end: End,
    /// Bytes that were typed so far.
    typed: usize,
}

enum End {
    Socket {
        listener: TcpListener,
        user: Option<TcpStream>,
    },
    /// The board's side, and the other one, which is kept open as a plugged-in adapter is.
    Serial {
        board: SerialPort,
        _port: SerialPort,
    },
    Unplugged,
}

impl Wire {
    /// A socket, and its name as `--port` takes it.
    pub fn socket() -> (Self, String) {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        listener.set_nonblocking(true).unwrap();
        let port = listener.local_addr().unwrap().port();
        let end = End::Socket { listener, user: None };
        (Self { end, typed: 0 }, format!("tcp:127.0.0.1:{port}"))
    }

    /// A serial port, and its path.
    #[cfg(target_os = "linux")]
    pub fn serial() -> (Self, String) {
        use std::os::fd::AsRawFd;
        let (first, second) = SerialPort::pair().unwrap();
        let path = |port: &SerialPort| {
            let link = format!("/proc/self/fd/{}", port.as_raw_fd());
            std::fs::read_link(link).unwrap().display().to_string()
        };
        let (mut board, port) = match path(&first).starts_with("/dev/pts/") {
            true => (second, first),
            false => (first, second),
        };
        let name = path(&port);
        assert!(name.starts_with("/dev/pts/"), "{name}");
        board.set_read_timeout(LOOK).unwrap();
        board.set_write_timeout(ROOM).unwrap();
        let end = End::Serial { board, _port: port };
        (Self { end, typed: 0 }, name)
    }

    /// Pulls the plug, for good.
    pub fn unplug(&mut self) {
        self.end = End::Unplugged;
    }

    /// Sends `said`; what was typed, less each `loses`th byte.
    pub fn exchange(&mut self, said: &[u8], loses: Option<usize>) -> Vec<u8> {
        let mut bytes = [0; 256];
        let count = match &mut self.end {
            End::Socket { listener, user } => socket(listener, user, said, &mut bytes),
            End::Serial { board, .. } => {
                // What finds no room is lost, as on a line without a reader.
                let _ = board.write_all(said);
                board.read(&mut bytes).unwrap_or(0)
            }
            End::Unplugged => 0,
        };
        let mut typed = Vec::new();
        for byte in &bytes[..count] {
            self.typed += 1;
            if loses.is_none_or(|every| !self.typed.is_multiple_of(every)) {
                typed.push(*byte);
            }
        }
        typed
    }
}

fn socket(listener: &TcpListener, latest: &mut Option<TcpStream>, said: &[u8], bytes: &mut [u8]) -> usize {
    if let Ok((user, _)) = listener.accept() {
        user.set_nonblocking(true).unwrap();
        *latest = Some(user);
    }
    let Some(user) = latest else {
        return 0;
    };
    let count = match user.read(bytes) {
        Ok(0) => None,
        Ok(count) => Some(count),
        Err(error) if error.kind() == ErrorKind::WouldBlock => Some(0),
        Err(_) => None,
    };
    if count.is_none() || user.write_all(said).is_err() {
        *latest = None;
    }
    count.unwrap_or(0)
}
