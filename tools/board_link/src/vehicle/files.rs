//! Files of the vehicle, read by MAVLink's FTP: piece by piece, each asked for until it has come.

use sophie_dialect::{FILE_TRANSFER_PROTOCOL_DATA, MavMessage};
use sophie_mavlink::services::ftp::{HEADER, Head, PAYLOAD, op};
use sophie_mavlink::wire::frame::{COMPONENT, SYSTEM};

use super::Vehicle;
use crate::Failure;
use crate::station::{STATION, STATION_COMPONENT};

/// Largest file that is read, bytes: a hundred times the description of the parameters.
const LARGEST: usize = 1 << 20;

impl Vehicle {
    /// The file at `path` below the root; `None` if the vehicle has none there, or not all of it.
    ///
    /// # Errors
    /// The line is lost, the vehicle falls silent, or Ctrl-C.
    pub fn file(&mut self, path: &str) -> Result<Option<Vec<u8>>, Failure> {
        let open = Head {
            op: op::OPEN_FILE_RO,
            ..Head::default()
        };
        let Some((opened, size)) = self.piece(open, path.as_bytes())? else {
            return Ok(None);
        };
        let size = size
            .first_chunk()
            .map_or(0, |size| u32::from_le_bytes(*size) as usize);
        let mut bytes = Vec::new();
        while bytes.len() < size.min(LARGEST) {
            let read = Head {
                session: opened.session,
                op: op::READ_FILE,
                offset: bytes.len() as u32,
                ..Head::default()
            };
            match self.piece(read, &[])? {
                Some((_, piece)) if !piece.is_empty() => bytes.extend(piece),
                _ => break,
            }
        }
        let close = Head {
            session: opened.session,
            op: op::TERMINATE_SESSION,
            ..Head::default()
        };
        self.piece(close, &[])?;
        Ok((bytes.len() == size).then_some(bytes))
    }

    /// The answer to `request`, with its data; `None` if it is refused.
    fn piece(&mut self, request: Head, data: &[u8]) -> Result<Option<(Head, Vec<u8>)>, Failure> {
        // The answer to a request before, which comes late, has another number.
        self.sequence = self.sequence.wrapping_add(2);
        let request = Head {
            sequence: self.sequence,
            ..request
        };
        let message = FILE_TRANSFER_PROTOCOL_DATA {
            target_network: 0,
            target_system: SYSTEM,
            target_component: COMPONENT,
            payload: request.with(data),
        };
        let (head, data) = self.asked("a file was asked for", &message, |message| {
            let MavMessage::FILE_TRANSFER_PROTOCOL(answer) = message else {
                return None;
            };
            let here = (answer.target_system, answer.target_component) == (STATION, STATION_COMPONENT);
            answers(&answer.payload, &request).filter(|_| here)
        })?;
        Ok((head.op == op::ACK).then_some((head, data)))
    }
}

/// Head and data of `payload`, if it answers `request`.
fn answers(payload: &[u8; PAYLOAD], request: &Head) -> Option<(Head, Vec<u8>)> {
    let head = Head::of(payload);
    let same = (head.sequence, head.request) == (request.sequence.wrapping_add(1), request.op);
    let data = payload.get(HEADER..)?.get(..usize::from(head.size))?;
    same.then(|| (head, data.to_vec()))
}
