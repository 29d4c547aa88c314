//! MAVLink over UDP: a fixed destination and one more client, the first that sends.

use std::io::ErrorKind;
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

/// Most datagrams taken at once; the socket drops the rest of a flood.
const AT_ONCE: usize = 16;
/// Longest datagram: more than Ethernet carries.
const LONGEST: usize = 2048;
/// Silence after which a client makes room for another; clients send a heartbeat each second.
const SILENT: Duration = Duration::from_secs(10);

/// A socket on an ephemeral port that sends to a fixed destination and to one client more, the first that sends
/// something from elsewhere. Never waits.
#[derive(Debug)]
pub struct Udp {
    socket: UdpSocket,
    destination: SocketAddr,
    client: Option<Client>,
    /// The refusal of a send has been reported.
    reported: bool,
}

#[derive(Clone, Copy, Debug)]
struct Client {
    address: SocketAddr,
    heard: Instant,
}

impl Udp {
    /// A socket that sends to `destination`; nothing needs to listen there.
    ///
    /// # Errors
    /// One line: the destination, and why the socket failed.
    pub fn open(destination: SocketAddr) -> Result<Self, String> {
        let local = match destination.ip() {
            ip if ip.is_loopback() => ip,
            IpAddr::V4(_) => Ipv4Addr::UNSPECIFIED.into(),
            IpAddr::V6(_) => Ipv6Addr::UNSPECIFIED.into(),
        };
        let socket = UdpSocket::bind((local, 0)).and_then(|socket| {
            socket.set_nonblocking(true)?;
            Ok(socket)
        });
        Ok(Self {
            socket: socket.map_err(|e| format!("{destination}: cannot open a UDP socket: {e}"))?,
            destination,
            client: None,
            reported: false,
        })
    }

    /// The local port for clients, and the destination.
    #[must_use]
    pub fn shown(&self) -> String {
        let local = self.socket.local_addr().map_or(0, |address| address.port());
        format!("UDP port {local}, sending to {}", self.destination)
    }

    /// Passes each datagram of the destination and the client to `take`.
    pub fn receive(&mut self, mut take: impl FnMut(&[u8])) {
        let mut datagram = [0; LONGEST];
        for _ in 0..AT_ONCE {
            match self.socket.recv_from(&mut datagram) {
                Ok((length, from)) if self.knows(from) => take(&datagram[..length]),
                Err(e) if e.kind() == ErrorKind::WouldBlock => break,
                // A datagram of a stranger, or a host's report that a datagram found no listener.
                Ok(_) | Err(_) => {}
            }
        }
    }

    /// True for the destination and the client; a stranger takes the place of a client that is silent.
    fn knows(&mut self, from: SocketAddr) -> bool {
        if from == self.destination {
            return true;
        }
        let heard = Instant::now();
        let free = self
            .client
            .is_none_or(|client| client.address == from || heard - client.heard > SILENT);
        if free {
            self.client = Some(Client { address: from, heard });
        }
        free
    }

    /// Sends `frame` to the destination and the client. Returns a message once, in one line, if the host refuses; a
    /// missing listener does not count as a refusal.
    pub fn send(&mut self, frame: &[u8]) -> Option<String> {
        let client = self.client.map(|client| client.address);
        for to in [Some(self.destination), client].into_iter().flatten() {
            let Err(why) = self.socket.send_to(frame, to) else {
                continue;
            };
            let passes = [
                ErrorKind::WouldBlock,
                ErrorKind::ConnectionRefused,
                ErrorKind::ConnectionReset,
            ];
            if !passes.contains(&why.kind()) && !std::mem::replace(&mut self.reported, true) {
                return Some(format!("MAVLink: {to}: cannot be sent to: {why}"));
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn socket() -> (UdpSocket, SocketAddr) {
        let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        socket.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
        let address = socket.local_addr().unwrap();
        (socket, address)
    }

    /// What arrives within a second at the latest.
    fn received(udp: &mut Udp) -> Vec<Vec<u8>> {
        let mut taken = vec![];
        let began = Instant::now();
        while taken.is_empty() && began.elapsed() < Duration::from_secs(1) {
            udp.receive(|datagram| taken.push(datagram.to_vec()));
        }
        taken
    }

    fn heard(socket: &UdpSocket) -> Vec<u8> {
        let mut bytes = [0; 64];
        loop {
            match socket.recv_from(&mut bytes) {
                // A call with a time limit is not restarted after a signal.
                Err(e) if e.kind() == ErrorKind::Interrupted => {}
                received => return bytes[..received.unwrap().0].to_vec(),
            }
        }
    }

    #[test]
    fn the_destination_and_the_first_other_client_are_served() {
        let (station, at) = socket();
        let mut udp = Udp::open(at).unwrap();
        let own = udp.socket.local_addr().unwrap();
        assert_eq!(udp.send(b"one"), None);
        assert_eq!(heard(&station), b"one");
        station.send_to(b"yes", own).unwrap();
        assert_eq!(received(&mut udp), [b"yes"]);
        let (first, _) = socket();
        first.send_to(b"first", own).unwrap();
        assert_eq!(received(&mut udp), [b"first"]);
        let (second, from) = socket();
        second.send_to(b"second", own).unwrap();
        assert!(received(&mut udp).is_empty());
        assert_eq!(udp.send(b"two"), None);
        assert_eq!(
            (heard(&station), heard(&first)),
            (b"two".to_vec(), b"two".to_vec())
        );
        // A client that has gone makes room.
        let client = udp.client.as_mut().unwrap();
        client.heard -= SILENT + Duration::from_secs(1);
        second.send_to(b"second", own).unwrap();
        assert_eq!(received(&mut udp), [b"second"]);
        assert_eq!(udp.client.unwrap().address, from);
    }

    #[test]
    fn a_destination_without_a_listener_is_no_error() {
        let (gone, at) = socket();
        drop(gone);
        let mut udp = Udp::open(at).unwrap();
        for _ in 0..100 {
            assert_eq!(udp.send(b"hello"), None);
            udp.receive(|_| panic!("nobody sent"));
        }
    }

    #[test]
    fn a_refusal_of_the_host_is_reported_once() {
        // Broadcasts are not enabled.
        let mut udp = Udp::open((Ipv4Addr::BROADCAST, 14550).into()).unwrap();
        let reported = udp.send(b"hello").unwrap();
        assert!(
            reported.starts_with("MAVLink: 255.255.255.255:14550: cannot be sent to: "),
            "{reported}"
        );
        assert_eq!(udp.send(b"hello"), None);
    }

    #[test]
    fn a_flood_is_taken_in_a_bit_at_a_time() {
        let (station, at) = socket();
        let mut udp = Udp::open(at).unwrap();
        let own = udp.socket.local_addr().unwrap();
        for _ in 0..1000 {
            station.send_to(&[0; 512], own).unwrap();
        }
        let mut count = 0;
        udp.receive(|_| count += 1);
        assert_eq!(count, AT_ONCE);
    }
}
