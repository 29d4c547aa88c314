//! The board's serial lines on sockets.

use std::io::{ErrorKind, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};

/// Bytes per millisecond: more than the line carries.
const AT_ONCE: usize = 64;

/// Lines on sockets.
#[derive(Default)]
pub struct Sockets {
    /// Console, both ways.
    pub console: Option<Terminal>,
    /// Output to the receiver; input is dropped, as the pilot has the line.
    pub telemetry: Option<Terminal>,
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

    /// Sends `said` and returns the user's input, without waiting.
    pub fn exchange(&mut self, said: &[u8]) -> Vec<u8> {
        if let Ok((user, _)) = self.listener.accept()
            && user.set_nonblocking(true).is_ok()
        {
            self.user = Some(user);
        }
        let Some(user) = &mut self.user else {
            return Vec::new();
        };
        let mut typed = [0; AT_ONCE];
        let read = user.read(&mut typed);
        let gone = match &read {
            Ok(count) => *count == 0,
            Err(e) => e.kind() != ErrorKind::WouldBlock,
        };
        if gone || user.write_all(said).is_err() {
            self.user = None;
        }
        typed[..read.unwrap_or(0)].to_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_typed_and_said_crosses_and_a_user_may_go() {
        let mut terminal = Terminal::listen("--console", 0).unwrap();
        let port = terminal.listener.local_addr().unwrap().port();
        let told = Terminal::listen("--telemetry", port).err().unwrap();
        assert!(
            told.starts_with(&format!("--telemetry {port}: ")) && !told.contains('\n'),
            "{told}"
        );
        assert!(terminal.exchange(b"lost").is_empty());
        for _ in 0..2 {
            let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
            user.write_all(b"help\n").unwrap();
            let mut typed = Vec::new();
            while typed.len() < 5 {
                typed.extend(terminal.exchange(b""));
            }
            assert_eq!(typed, b"help\n");
            terminal.exchange(b"hi");
            let mut heard = [0; 2];
            user.read_exact(&mut heard).unwrap();
            assert_eq!(&heard, b"hi");
        }
        while terminal.user.is_some() {
            terminal.exchange(b"");
        }
    }
}
