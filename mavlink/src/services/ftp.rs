//! Read-only files over MAVLink's FTP: the description of the parameters, for ground stations.
//!
//! The session number of a file is its index, and an answer goes to its requester. So any number of readers can read at
//! once, a repeated request gets its answer again, and a reader that leaves leaves no session open. At most `BURSTS`
//! readers are sent bursts, in turn; a further reader gets a burst of one piece and asks for the next, as the protocol
//! allows.

use heapless::Deque;

use crate::services::files::{File, crc32};
use crate::wire::requests::Peer;

/// Bytes of the message's payload: a header and data.
pub const PAYLOAD: usize = 251;
/// Bytes of the header.
pub const HEADER: usize = 12;
/// Bytes of a file in a message at most.
const DATA: usize = PAYLOAD - HEADER;
/// Largest number of simultaneous bursts.
const BURSTS: usize = 4;
/// Largest number of waiting answers: one for each reader, and its burst. An answer without room is dropped; the reader
/// asks again.
const WAITING: usize = 2 * BURSTS;

/// Opcodes of the protocol, for both of its ends.
#[expect(missing_docs, reason = "the names are the protocol's")]
pub mod op {
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

/// Error codes of the protocol.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
enum ErrorCode {
    InvalidDataSize = 3,
    InvalidSession = 4,
    EndOfFile = 6,
    UnknownCommand = 7,
    FileProtected = 9,
    FileNotFound = 10,
}

/// Head of a request or an answer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Head {
    /// Number of a request; its answer has the next one.
    pub sequence: u16,
    /// Session of the open file.
    pub session: u8,
    /// Opcode.
    pub op: u8,
    /// Bytes of data; in a read, those that are asked for.
    pub size: u8,
    /// In an answer: opcode of its request.
    pub request: u8,
    /// The last message of a burst.
    pub burst_complete: bool,
    /// Place in the file, bytes.
    pub offset: u32,
}

impl Head {
    /// The head of `payload`.
    pub fn of(payload: &[u8; PAYLOAD]) -> Self {
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

    /// The payload: this head and `data`, cut to its room; its size is that of `data`.
    #[must_use]
    pub fn with(mut self, data: &[u8]) -> [u8; PAYLOAD] {
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

/// The content of an answer.
#[derive(Clone, Copy, Debug)]
enum Answer {
    Done,
    Refused(ErrorCode),
    Number(u32),
    /// The directory, from the head's offset on.
    List,
    /// This many bytes of the session's file, from the head's offset on.
    Piece(u8),
    /// The same, as part of a burst.
    Burst {
        size: u8,
        /// The rest follows.
        continues: bool,
    },
}

/// An answer that waits for room on the line.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    to: Peer,
    head: Head,
    answer: Answer,
}

impl Waiting {
    const fn bursts(&self) -> bool {
        matches!(self.answer, Answer::Burst { .. })
    }
}

/// The server of some files.
pub struct Ftp {
    files: &'static [File],
    waiting: Deque<Waiting, WAITING>,
}

impl Ftp {
    /// A server of `files`, at most 255, each by its path.
    pub const fn new(files: &'static [File]) -> Self {
        Self {
            files,
            waiting: Deque::new(),
        }
    }

    /// Takes a request of `from`. Answers of other servers are ignored.
    pub fn ask(&mut self, from: Peer, payload: &[u8; PAYLOAD]) {
        let request = Head::of(payload);
        if matches!(request.op, op::ACK | op::NAK) {
            return;
        }
        let data = payload
            .get(HEADER..)
            .and_then(|data| data.get(..usize::from(request.size)));
        let mut head = Head {
            sequence: request.sequence.wrapping_add(1),
            op: op::ACK,
            request: request.op,
            burst_complete: false,
            ..request
        };
        let answer = match self.obey(from, &mut head, data.map(path)) {
            Ok(answer) => answer,
            Err(refusal) => {
                head.op = op::NAK;
                Answer::Refused(refusal)
            }
        };
        let new = Waiting {
            to: from,
            head,
            answer,
        };
        // The newest request replaces an older one of the same reader, which would be repeated if it mattered.
        let mut waiting = self.waiting.iter_mut();
        match waiting.find(|old| old.to == from && old.bursts() == new.bursts()) {
            Some(old) => *old = new,
            None => {
                let _ = self.waiting.push_back(new);
            }
        }
    }

    /// The next answer and its reader.
    pub fn answer(&mut self) -> Option<(Peer, [u8; PAYLOAD])> {
        let Waiting { to, head, answer } = self.waiting.pop_front()?;
        let payload = match answer {
            Answer::Done => head.with(&[]),
            Answer::Refused(refusal) => head.with(&[refusal as u8]),
            Answer::Number(number) => head.with(&number.to_le_bytes()),
            Answer::List => head.with(&self.list(head.offset)),
            Answer::Piece(size) => head.with(self.piece(head, size).0),
            Answer::Burst { size, continues } => {
                let (piece, more) = self.piece(head, size);
                if more && continues {
                    let next = Head {
                        offset: head.offset.saturating_add(piece.len() as u32),
                        sequence: head.sequence.wrapping_add(1),
                        ..head
                    };
                    let rest = Waiting {
                        to,
                        head: next,
                        answer,
                    };
                    let _ = self.waiting.push_back(rest);
                }
                let burst_complete = !(more && continues);
                Head {
                    burst_complete,
                    ..head
                }
                .with(piece)
            }
        };
        Some((to, payload))
    }

    fn obey(&mut self, from: Peer, head: &mut Head, path: Option<&[u8]>) -> Result<Answer, ErrorCode> {
        match head.request {
            op::NONE => Ok(Answer::Done),
            op::TERMINATE_SESSION | op::RESET_SESSIONS => {
                self.forget(from);
                Ok(Answer::Done)
            }
            op::LIST_DIRECTORY => {
                let path = path.ok_or(ErrorCode::InvalidDataSize)?;
                if !path.is_empty() && path != b"." {
                    return Err(ErrorCode::FileNotFound);
                }
                let more = (head.offset as usize) < self.files.len();
                more.then_some(Answer::List).ok_or(ErrorCode::EndOfFile)
            }
            op::OPEN_FILE_RO | op::CALC_FILE_CRC32 => {
                let (session, file) = self.find(path.ok_or(ErrorCode::InvalidDataSize)?)?;
                if head.request == op::CALC_FILE_CRC32 {
                    return Ok(Answer::Number(crc32(file.bytes)));
                }
                head.session = session;
                Ok(Answer::Number(file.bytes.len() as u32))
            }
            op::READ_FILE | op::BURST_READ_FILE => {
                let file = self.files.get(usize::from(head.session));
                if rest(file.ok_or(ErrorCode::InvalidSession)?, *head).is_empty() {
                    return Err(ErrorCode::EndOfFile);
                }
                let size = wanted(head.size);
                if head.request == op::READ_FILE {
                    return Ok(Answer::Piece(size));
                }
                let others = self.waiting.iter().filter(|w| w.bursts() && w.to != from);
                let continues = others.count() < BURSTS;
                Ok(Answer::Burst { size, continues })
            }
            op::CREATE_FILE..=op::RENAME => Err(ErrorCode::FileProtected),
            _ => Err(ErrorCode::UnknownCommand),
        }
    }

    /// Drops the answers that wait for `reader`.
    fn forget(&mut self, reader: Peer) {
        for _ in 0..self.waiting.len() {
            if let Some(waiting) = self.waiting.pop_front()
                && waiting.to != reader
            {
                let _ = self.waiting.push_back(waiting);
            }
        }
    }

    /// The entries of the one directory from the one at `offset` on, as many as fit: `F`, name, tab, size, 0.
    fn list(&self, offset: u32) -> heapless::Vec<u8, DATA> {
        let mut entries = heapless::Vec::new();
        for file in self.files.iter().skip(offset as usize) {
            let mut entry = heapless::String::<64>::new();
            let written =
                core::fmt::write(&mut entry, format_args!("F{}\t{}\0", file.path, file.bytes.len()));
            if written.is_err() || entries.extend_from_slice(entry.as_bytes()).is_err() {
                break;
            }
        }
        entries
    }

    /// The file at `path` with its session.
    fn find(&self, path: &[u8]) -> Result<(u8, &'static File), ErrorCode> {
        let mut numbered = (0..).zip(self.files);
        let found = numbered.find(|(_, file)| file.path.as_bytes() == path);
        found.ok_or(ErrorCode::FileNotFound)
    }

    /// Up to `size` bytes of the head's session from its offset on; true if more follow.
    fn piece(&self, head: Head, size: u8) -> (&'static [u8], bool) {
        let file = self.files.get(usize::from(head.session));
        let rest = file.map_or(&[][..], |file| rest(file, head));
        match rest.split_at_checked(size.into()) {
            Some((piece, more)) => (piece, !more.is_empty()),
            None => (rest, false),
        }
    }
}

/// The bytes of `file` from the head's offset on.
fn rest(file: &File, head: Head) -> &'static [u8] {
    file.bytes.get(head.offset as usize..).unwrap_or_default()
}

/// Bytes that a read asks for by its `size`: 0 asks for as many as fit.
fn wanted(size: u8) -> u8 {
    match size {
        0 => DATA as u8,
        size => size.min(DATA as u8),
    }
}

/// A path without the root's slash and the padding.
fn path(data: &[u8]) -> &[u8] {
    let end = data.iter().position(|byte| *byte == 0).unwrap_or(data.len());
    let path = data.get(..end).unwrap_or_default();
    path.strip_prefix(b"/").unwrap_or(path)
}

#[cfg(test)]
mod tests;
