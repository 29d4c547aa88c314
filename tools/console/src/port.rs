//! Where the console is: a serial port, or a TCP socket as the emulated board has it.

use std::fmt;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use crate::Failure;

/// The console's rate on serial ports.
pub const BAUD: u32 = 115_200;
/// Longest wait of one read or write: how finely a session counts silence.
const SLICE: Duration = Duration::from_millis(20);
/// Longest wait of a write, after which the line counts as lost.
const WRITE: Duration = Duration::from_secs(2);
/// Longest wait for a TCP connection.
const CONNECT: Duration = Duration::from_secs(5);

/// Name of a port: `/dev/ttyUSB0`, `COM3`, `tcp:127.0.0.1:5000`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortName {
    /// A serial port.
    Serial(PathBuf),
    /// HOST:PORT.
    Tcp(String),
}

/// Both ways of a line. A read returns [`ErrorKind::TimedOut`] or [`ErrorKind::WouldBlock`] within some milliseconds
/// where nothing comes.
pub trait Wire: Read + Write + Send {}
impl<T: Read + Write + Send> Wire for T {}

impl FromStr for PortName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let Some(address) = text.strip_prefix("tcp:") else {
            return match text {
                "" => Err("allowed /dev/..., COM3 or tcp:HOST:PORT".to_owned()),
                _ => Ok(Self::Serial(PathBuf::from(text))),
            };
        };
        match address.rsplit_once(':') {
            Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok_and(|port| port > 0) => {
                Ok(Self::Tcp(address.to_owned()))
            }
            _ => Err("allowed tcp:HOST:PORT, PORT 1 to 65535".to_owned()),
        }
    }
}

impl fmt::Display for PortName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(path) => write!(f, "{}", path.display()),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

impl PortName {
    /// Opens the port.
    ///
    /// # Errors
    /// One line: the port, and why it cannot be used.
    pub fn open(&self) -> Result<Box<dyn Wire>, Failure> {
        let opened = match self {
            Self::Serial(path) => serial(path),
            Self::Tcp(address) => tcp(address),
        };
        opened.map_err(|error| {
            let hint = match (self, error.kind()) {
                (Self::Serial(_), ErrorKind::ResourceBusy | ErrorKind::WouldBlock) => {
                    "; close the other terminal"
                }
                (Self::Serial(_), ErrorKind::PermissionDenied) => {
                    "; on Linux join the group of the port, dialout"
                }
                (Self::Serial(path), _) if path.exists() => "; it is no serial port, or none that is ready",
                _ => "",
            };
            Failure::Input(format!("{self}: cannot be opened: {error}{hint}"))
        })
    }
}

fn serial(path: &PathBuf) -> io::Result<Box<dyn Wire>> {
    let mut port = serial2::SerialPort::open(path, BAUD)?;
    lock(&port)?;
    port.set_read_timeout(SLICE)?;
    port.set_write_timeout(WRITE)?;
    Ok(Box::new(port))
}

/// Takes the port for this process alone, as terminal programs do. It is given back with the port's last handle.
#[cfg(unix)]
fn lock(port: &serial2::SerialPort) -> io::Result<()> {
    use std::os::fd::AsFd;
    let file = File::from(port.as_fd().try_clone_to_owned()?);
    file.try_lock().map_err(|error| match error {
        std::fs::TryLockError::WouldBlock => {
            io::Error::new(ErrorKind::ResourceBusy, "another program has it")
        }
        std::fs::TryLockError::Error(error) => error,
    })
}

/// Elsewhere an open port is the process's own.
#[cfg(not(unix))]
fn lock(_port: &serial2::SerialPort) -> io::Result<()> {
    Ok(())
}

fn tcp(address: &str) -> io::Result<Box<dyn Wire>> {
    let mut last = io::Error::new(ErrorKind::NotFound, "no such host");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(SLICE))?;
                stream.set_write_timeout(Some(WRITE))?;
                return Ok(Box::new(stream));
            }
            Err(error) => last = error,
        }
    }
    Err(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_and_shown() {
        for text in ["/dev/ttyUSB0", "COM3", "tcp:127.0.0.1:5000", "tcp:bench.local:1"] {
            assert_eq!(text.parse::<PortName>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "tcp:",
            "tcp:host",
            "tcp:host:",
            "tcp::80",
            "tcp:host:0",
            "tcp:host:65536",
        ] {
            assert!(
                text.parse::<PortName>().unwrap_err().starts_with("allowed "),
                "{text}"
            );
        }
    }

    #[test]
    fn a_port_that_is_not_there_is_named() {
        for name in ["/dev/no-such-port", "tcp:127.0.0.1:1"] {
            let Err(Failure::Input(line)) = name.parse::<PortName>().unwrap().open() else {
                panic!("{name} was opened");
            };
            assert!(
                line.starts_with(&format!("{name}: cannot be opened: ")) && !line.contains('\n'),
                "{line}"
            );
        }
    }
}
