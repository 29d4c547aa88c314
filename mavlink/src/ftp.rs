//! Files over MAVLink's FTP, read only: what a ground station needs to know of the parameters.
//!
//! A file's session is its number, so the server remembers no reader: any number of them may read at once, a request that
//! is repeated gets its answer again, and a reader that leaves without a word leaves nothing open. Only a burst is
//! remembered, one at a time; a reader whose burst another one ends asks for the rest.

use crate::files::{File, crc32};

/// Bytes of the message's payload: a header and data.
pub const PAYLOAD: usize = 251;
/// Bytes of the header.
const HEADER: usize = 12;
/// Bytes of a file in a message at most.
const DATA: usize = PAYLOAD - HEADER;

/// Requests, by their numbers in the protocol.
mod op {
    pub const NONE: u8 = 0;
    pub const TERMINATE_SESSION: u8 = 1;
    pub const RESET_SESSIONS: u8 = 2;
    pub const LIST_DIRECTORY: u8 = 3;
    pub const OPEN_FILE_RO: u8 = 4;
    pub const READ_FILE: u8 = 5;
    pub const CREATE_FILE: u8 = 6;
    pub const RENAME: u8 = 13;
    pub const CALC_FILE_CRC32: u8 = 14;
    pub const BURST_READ_FILE: u8 = 15;
    pub const ACK: u8 = 128;
    pub const NAK: u8 = 129;
}

/// Why a request is refused, by its number in the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum Refusal {
    InvalidDataSize = 3,
    InvalidSession = 4,
    EndOfFile = 6,
    UnknownCommand = 7,
    FileProtected = 9,
    FileNotFound = 10,
}

/// Head of a request or an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Head {
    sequence: u16,
    session: u8,
    op: u8,
    size: u8,
    request: u8,
    burst_complete: bool,
    offset: u32,
}

impl Head {
    fn of(payload: &[u8; PAYLOAD]) -> Self {
        let [s0, s1, session, op, size, request, burst, _, o0, o1, o2, o3, ..] = *payload;
        Self {
            sequence: u16::from_le_bytes([s0, s1]),
            session,
            op,
            size,
            request,
            burst_complete: burst != 0,
            offset: u32::from_le_bytes([o0, o1, o2, o3]),
        }
    }

    /// The payload with `data` behind this head; what is too long is cut off.
    fn with(mut self, data: &[u8]) -> [u8; PAYLOAD] {
        let mut payload = [0; PAYLOAD];
        let (head, room) = payload.split_at_mut(HEADER);
        let mut size = 0;
        for (to, from) in room.iter_mut().zip(data) {
            *to = *from;
            size += 1;
        }
        self.size = size;
        let ([s0, s1], [o0, o1, o2, o3]) = (self.sequence.to_le_bytes(), self.offset.to_le_bytes());
        let burst = u8::from(self.burst_complete);
        head.copy_from_slice(&[
            s0,
            s1,
            self.session,
            self.op,
            self.size,
            self.request,
            burst,
            0,
            o0,
            o1,
            o2,
            o3,
        ]);
        payload
    }
}

/// A file that is sent piece by piece without being asked for each.
#[derive(Clone, Copy, Debug)]
struct Burst {
    file: &'static File,
    /// Head of the piece that is next.
    next: Head,
    /// Bytes in a piece.
    size: usize,
}

/// The server of some files.
pub struct Ftp {
    files: &'static [File],
    burst: Option<Burst>,
}

impl Ftp {
    /// A server of `files`, at most 255, each by its path.
    pub const fn new(files: &'static [File]) -> Self {
        Self { files, burst: None }
    }

    /// The answer to a request; none to what is an answer itself, nor to the request for a burst, whose pieces
    /// [`Self::piece`] has.
    pub fn answer(&mut self, payload: &[u8; PAYLOAD]) -> Option<[u8; PAYLOAD]> {
        let request = Head::of(payload);
        if matches!(request.op, op::ACK | op::NAK) {
            return None;
        }
        let head = Head {
            sequence: request.sequence.wrapping_add(1),
            op: op::ACK,
            request: request.op,
            ..request
        };
        let data = payload
            .get(HEADER..)
            .and_then(|data| data.get(..usize::from(request.size)));
        let path = data.map(path);
        match self.obey(request, head, path) {
            Ok(answer) => answer,
            Err(refusal) => Some(Head { op: op::NAK, ..head }.with(&[refusal as u8])),
        }
    }

    /// True while pieces of a burst are due.
    pub const fn bursting(&self) -> bool {
        self.burst.is_some()
    }

    /// The next piece of the burst.
    pub fn piece(&mut self) -> Option<[u8; PAYLOAD]> {
        let burst = self.burst.as_mut()?;
        let from = burst.next.offset as usize;
        let Some(rest) = burst.file.bytes.get(from..).filter(|rest| !rest.is_empty()) else {
            self.burst = None;
            return None;
        };
        let piece = rest.get(..burst.size).unwrap_or(rest);
        let last = piece.len() == rest.len();
        let payload = Head {
            burst_complete: last,
            ..burst.next
        }
        .with(piece);
        burst.next.offset = burst.next.offset.saturating_add(piece.len() as u32);
        burst.next.sequence = burst.next.sequence.wrapping_add(1);
        if last {
            self.burst = None;
        }
        Some(payload)
    }

    fn obey(
        &mut self,
        request: Head,
        head: Head,
        path: Option<&[u8]>,
    ) -> Result<Option<[u8; PAYLOAD]>, Refusal> {
        match request.op {
            op::NONE | op::TERMINATE_SESSION | op::RESET_SESSIONS => {
                self.burst = None;
                Ok(Some(head.with(&[])))
            }
            op::LIST_DIRECTORY => self.list(head, path.ok_or(Refusal::InvalidDataSize)?).map(Some),
            op::OPEN_FILE_RO | op::CALC_FILE_CRC32 => {
                let (session, file) = self.find(path.ok_or(Refusal::InvalidDataSize)?)?;
                let (head, number) = if request.op == op::OPEN_FILE_RO {
                    (Head { session, ..head }, file.bytes.len() as u32)
                } else {
                    (head, crc32(file.bytes))
                };
                Ok(Some(head.with(&number.to_le_bytes())))
            }
            op::READ_FILE => {
                let rest = self.rest(request)?;
                Ok(Some(head.with(rest.get(..wanted(request)).unwrap_or(rest))))
            }
            op::BURST_READ_FILE => {
                self.rest(request)?;
                let file = self.session(request)?;
                let size = wanted(request);
                self.burst = Some(Burst {
                    file,
                    next: head,
                    size,
                });
                Ok(None)
            }
            op::CREATE_FILE..=op::RENAME => Err(Refusal::FileProtected),
            _ => Err(Refusal::UnknownCommand),
        }
    }

    /// The entries of the one directory from the one that is asked for on, as many as fit: `F`, name, tab, size, 0.
    fn list(&self, head: Head, path: &[u8]) -> Result<[u8; PAYLOAD], Refusal> {
        if !path.is_empty() && path != b"." {
            return Err(Refusal::FileNotFound);
        }
        let mut entries = heapless::Vec::<u8, DATA>::new();
        for file in self.files.iter().skip(head.offset as usize) {
            let mut entry = heapless::String::<64>::new();
            let written =
                core::fmt::write(&mut entry, format_args!("F{}\t{}\0", file.path, file.bytes.len()));
            if written.is_err() || entries.extend_from_slice(entry.as_bytes()).is_err() {
                break;
            }
        }
        if entries.is_empty() {
            return Err(Refusal::EndOfFile);
        }
        Ok(head.with(&entries))
    }

    /// The file at `path` with its session.
    fn find(&self, path: &[u8]) -> Result<(u8, &'static File), Refusal> {
        let mut numbered = (0..).zip(self.files);
        let found = numbered.find(|(_, file)| file.path.as_bytes() == path);
        found.ok_or(Refusal::FileNotFound)
    }

    fn session(&self, request: Head) -> Result<&'static File, Refusal> {
        self.files
            .get(usize::from(request.session))
            .ok_or(Refusal::InvalidSession)
    }

    /// What the file of the session has from the offset on.
    fn rest(&self, request: Head) -> Result<&'static [u8], Refusal> {
        let file = self.session(request)?;
        let rest = file.bytes.get(request.offset as usize..).unwrap_or_default();
        if rest.is_empty() {
            return Err(Refusal::EndOfFile);
        }
        Ok(rest)
    }
}

/// Bytes that a read asks for: 0 asks for as many as fit.
fn wanted(request: Head) -> usize {
    match usize::from(request.size) {
        0 => DATA,
        size => size.min(DATA),
    }
}

/// A path without the root's slash and without what fills it up.
fn path(data: &[u8]) -> &[u8] {
    let end = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    let path = data.get(..end).unwrap_or_default();
    path.strip_prefix(b"/").unwrap_or(path)
}

#[cfg(test)]
mod tests;
