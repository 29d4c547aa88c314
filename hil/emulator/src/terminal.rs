//! The board's serial lines on sockets.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

use crate::wires::FarEnd;

/// Most bytes that wait for the line: more than it carries in a millisecond. The others wait in the socket, which holds
/// up a client that sends faster.
const AT_ONCE: usize = 64;

/// Lines on sockets.
#[derive(Default)]
pub struct Sockets {
    /// Console, both ways.
    pub console: Option<Terminal>,
    /// Output to the receiver; input is dropped, as the pilot has the line.
    pub telemetry: Option<Terminal>,
    /// MAVLink, both ways.
    pub mavlink: Option<Terminal>,
}

/// A loopback listener; the latest connection counts.
pub struct Terminal {
    listener: TcpListener,
    user: Option<TcpStream>,
}

impl Terminal {
    /// A listener on `port`; errors name `option`.
    ///
    /// # Errors
    /// One line: the port, and why it is unavailable.
    pub fn listen(option: &str, port: u16) -> Result<Self, String> {
        let refused = |e: std::io::Error| format!("{option} {port}: cannot listen on 127.0.0.1:{port}: {e}");
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port)).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        Ok(Self { listener, user: None })
    }

    /// Sends the board's output on `line` to the user and returns the user's input. Never waits: bytes beyond the
    /// buffer of a user who does not read are lost.
    pub fn exchange(&mut self, line: &FarEnd) -> Vec<u8> {
        if let Ok((user, _)) = self.listener.accept()
            && user.set_nonblocking(true).is_ok()
        {
            self.user = Some(user);
        }
        let Some(user) = &mut self.user else {
            return Vec::new();
        };
        let mut typed = [0; AT_ONCE];
        let room = AT_ONCE.saturating_sub(line.waiting);
        // Reading nothing would look like the end of the connection.
        let read = if room > 0 {
            user.read(&mut typed[..room])
        } else {
            Err(ErrorKind::WouldBlock.into())
        };
        let gone = match &read {
            Ok(count) => *count == 0,
            Err(e) => is_end(e.kind()),
        };
        let sent = user.write_all(&line.heard);
        if gone || sent.is_err_and(|e| is_end(e.kind())) {
            self.user = None;
        }
        typed[..read.unwrap_or(0)].to_vec()
    }
}

/// The connection is over; otherwise it has nothing, or no room, at present.
fn is_end(error: ErrorKind) -> bool {
    !matches!(error, ErrorKind::WouldBlock | ErrorKind::Interrupted)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(text: &[u8]) -> FarEnd {
        FarEnd {
            heard: text.to_vec(),
            waiting: 0,
        }
    }

    fn terminal() -> (u16, Terminal) {
        let terminal = Terminal::listen("--console", 0).unwrap();
        (terminal.listener.local_addr().unwrap().port(), terminal)
    }

    #[test]
    fn bytes_cross_both_ways_and_a_user_may_disconnect() {
        let (port, mut terminal) = terminal();
        let complaint = Terminal::listen("--telemetry", port).err().unwrap();
        assert!(
            complaint.starts_with(&format!("--telemetry {port}: ")) && !complaint.contains('\n'),
            "{complaint}"
        );
        assert!(terminal.exchange(&said(b"lost")).is_empty());
        for _ in 0..2 {
            let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
            user.write_all(b"help\n").unwrap();
            let mut typed = Vec::new();
            while typed.len() < 5 {
                typed.extend(terminal.exchange(&said(b"")));
            }
            assert_eq!(typed, b"help\n");
            terminal.exchange(&said(b"hi"));
            let mut heard = [0; 2];
            user.read_exact(&mut heard).unwrap();
            assert_eq!(&heard, b"hi");
        }
        while terminal.user.is_some() {
            terminal.exchange(&said(b""));
        }
    }

    #[test]
    fn a_user_who_never_reads_loses_bytes_and_stays_connected() {
        let (port, mut terminal) = terminal();
        let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        while terminal.user.is_none() {
            terminal.exchange(&said(b""));
        }
        // Far beyond the buffers of both ends.
        let much = said(&[b'x'; 64 * 1024]);
        for _ in 0..1024 {
            terminal.exchange(&much);
        }
        user.write_all(b"?").unwrap();
        let mut typed = Vec::new();
        while typed.is_empty() {
            assert!(terminal.user.is_some());
            typed.extend(terminal.exchange(&said(b"")));
        }
        assert_eq!(typed, b"?");
    }

    #[test]
    fn a_flood_waits_in_the_socket_and_not_before_the_line() {
        let (port, mut terminal) = terminal();
        let user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        user.set_nonblocking(true).unwrap();
        let (mut sent, mut waiting) = (0, 0);
        for _ in 0..2000 {
            // 5 bytes a millisecond, as a line of 57,600 baud carries them.
            sent += (&user).write(&[0; 4096]).unwrap_or(0);
            waiting += terminal
                .exchange(&FarEnd {
                    heard: vec![],
                    waiting,
                })
                .len();
            assert!(waiting <= AT_ONCE, "{waiting}");
            waiting = waiting.saturating_sub(5);
        }
        assert!(sent > 100 * AT_ONCE && terminal.user.is_some(), "{sent}");
    }
}
