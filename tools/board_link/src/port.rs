//! The port of a vehicle: a serial port, a TCP socket (of an emulated board) or UDP, which carry MAVLink.

use std::fmt;
use std::fs::File;
use std::io::{self, ErrorKind};
use std::net::{TcpStream, ToSocketAddrs, UdpSocket};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

use crate::Failure;
use crate::station::{self, Ends};

/// Default rate of serial ports, baud: that of the boards' MAVLink ports. USB ignores it.
pub const BAUD: u32 = 57_600;
/// Rate of the boards' serial console, baud.
pub const CONSOLE_BAUD: u32 = 115_200;
/// Longest wait of one read or write: the resolution of time-outs.
const SLICE: Duration = Duration::from_millis(20);
/// Longest wait of a write; then the line counts as lost.
const WRITE: Duration = Duration::from_secs(2);
/// Longest wait for a TCP connection.
const CONNECT: Duration = Duration::from_secs(5);
/// The allowed names.
const ALLOWED: &str =
    "allowed /dev/...[,BAUD], COM3[,BAUD], tcp:HOST:PORT, udpin:HOST:PORT, udpout:HOST:PORT";

/// Name of a port: `/dev/ttyUSB0`, `COM3`, `tcp:127.0.0.1:5760`, in the notation of other clients of MAVLink.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PortName {
    /// A serial port and its rate.
    Serial(PathBuf, u32),
    /// HOST:PORT.
    Tcp(String),
    /// HOST:PORT of this computer, which the vehicle sends to.
    UdpIn(String),
    /// HOST:PORT of the vehicle.
    UdpOut(String),
}

impl FromStr for PortName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.strip_prefix("mavlink:").unwrap_or(text);
        // As in pymavlink, udp: without in or out listens.
        for listens in ["udpin:", "udp:"] {
            if let Some(at) = text.strip_prefix(listens) {
                return Ok(Self::UdpIn(address(at, listens)?));
            }
        }
        if let Some(to) = text.strip_prefix("udpout:") {
            return Ok(Self::UdpOut(address(to, "udpout:")?));
        }
        if let Some(to) = text.strip_prefix("tcp:") {
            return Ok(Self::Tcp(address(to, "tcp:")?));
        }
        match text.rsplit_once(',') {
            _ if text.is_empty() || text.starts_with("udp") => Err(ALLOWED.to_owned()),
            None => Ok(Self::Serial(PathBuf::from(text), BAUD)),
            Some((path, baud)) => match baud.parse() {
                Ok(baud @ 1200..=4_000_000) if !path.is_empty() => {
                    Ok(Self::Serial(PathBuf::from(path), baud))
                }
                _ => Err("allowed /dev/...,BAUD, BAUD 1200 to 4000000".to_owned()),
            },
        }
    }
}

/// HOST:PORT.
fn address(text: &str, before: &str) -> Result<String, String> {
    match text.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() && port.parse::<u16>().is_ok_and(|port| port > 0) => {
            Ok(text.to_owned())
        }
        _ => Err(format!("allowed {before}HOST:PORT, PORT 1 to 65535")),
    }
}

impl fmt::Display for PortName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(path, BAUD) => write!(f, "{}", path.display()),
            Self::Serial(path, baud) => write!(f, "{},{baud}", path.display()),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
            Self::UdpIn(address) => write!(f, "udpin:{address}"),
            Self::UdpOut(address) => write!(f, "udpout:{address}"),
        }
    }
}

impl PortName {
    /// Opens the port.
    ///
    /// # Errors
    /// One line: the port, and why it cannot be used.
    pub fn open(&self) -> Result<Ends, Failure> {
        self.ends().map_err(|error| self.cannot_be_opened(&error))
    }

    /// One line: the port, and why it cannot be used.
    fn cannot_be_opened(&self, error: &io::Error) -> Failure {
        let path = match self {
            Self::Serial(path, _) => Some(path),
            _ => None,
        };
        let hint = match (path, error.kind()) {
            (Some(_), ErrorKind::ResourceBusy | ErrorKind::WouldBlock) => "; close the other terminal",
            (Some(_), ErrorKind::PermissionDenied) => "; on Linux join the group of the port, dialout",
            (Some(path), _) if path.exists() => "; it is no serial port, or none that is ready",
            _ => "",
        };
        Failure::Input(format!("{self}: cannot be opened: {error}{hint}"))
    }

    fn ends(&self) -> io::Result<Ends> {
        Ok(match self {
            Self::Serial(path, baud) => {
                let port = serial(path, *baud)?;
                Ends {
                    input: Box::new(port.try_clone()?),
                    output: Box::new(port),
                }
            }
            Self::Tcp(address) => {
                let stream = tcp(address)?;
                Ends {
                    input: Box::new(stream.try_clone()?),
                    output: Box::new(stream),
                }
            }
            Self::UdpIn(address) => station::udp(udp(address)?, None)?,
            Self::UdpOut(address) => {
                let to = address.to_socket_addrs()?.next();
                let to = to.ok_or_else(|| io::Error::new(ErrorKind::NotFound, "no such host"))?;
                station::udp(udp(if to.is_ipv4() { "0.0.0.0:0" } else { "[::]:0" })?, Some(to))?
            }
        })
    }
}

fn udp(at: &str) -> io::Result<UdpSocket> {
    let socket = UdpSocket::bind(at)?;
    socket.set_read_timeout(Some(SLICE))?;
    Ok(socket)
}

fn serial(path: &PathBuf, baud: u32) -> io::Result<serial2::SerialPort> {
    let mut port = serial2::SerialPort::open(path, baud)?;
    lock(&port)?;
    port.set_read_timeout(SLICE)?;
    port.set_write_timeout(WRITE)?;
    Ok(port)
}

/// Locks the port for this process, as terminal programs do. The lock ends with the port's last handle.
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

fn tcp(address: &str) -> io::Result<TcpStream> {
    let mut last = io::Error::new(ErrorKind::NotFound, "no such host");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT) {
            Ok(stream) => {
                stream.set_nodelay(true)?;
                stream.set_read_timeout(Some(SLICE))?;
                stream.set_write_timeout(Some(WRITE))?;
                return Ok(stream);
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
        for text in [
            "/dev/ttyUSB0",
            "/dev/ttyUSB0,115200",
            "COM3",
            "tcp:127.0.0.1:5000",
            "tcp:bench.local:1",
            "udpin:0.0.0.0:14550",
            "udpout:10.0.0.2:14550",
        ] {
            assert_eq!(text.parse::<PortName>().unwrap().to_string(), text);
            let name = format!("mavlink:{text}");
            assert_eq!(name.parse::<PortName>().unwrap().to_string(), text);
        }
        for (text, shown) in [
            ("udp:127.0.0.1:14550", "udpin:127.0.0.1:14550"),
            ("/dev/ttyACM0,57600", "/dev/ttyACM0"),
        ] {
            assert_eq!(text.parse::<PortName>().unwrap().to_string(), shown);
        }
        for text in [
            "",
            "tcp:",
            "tcp:host",
            "tcp:host:",
            "tcp::80",
            "tcp:host:0",
            "tcp:host:65536",
            "mavlink:",
            "mavlink:/dev/ttyACM0,fast",
            "/dev/ttyACM0,0",
            ",57600",
            "udp:14550",
            "udpbcast:10.0.0.255:14550",
            "udpout:host:0",
        ] {
            assert!(
                text.parse::<PortName>().unwrap_err().starts_with("allowed "),
                "{text}"
            );
        }
    }

    #[test]
    fn a_port_that_is_not_there_is_named() {
        for name in ["/dev/no-such-port", "/dev/no-such-port,9600", "tcp:127.0.0.1:1"] {
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
