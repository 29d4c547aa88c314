//! Bytes to and from a board, whatever carries them.

use std::io::{Read, Write};

/// Both ways of a line. A read returns [`TimedOut`](std::io::ErrorKind::TimedOut) or [`WouldBlock`](std::io::ErrorKind::WouldBlock) within some milliseconds
/// where nothing comes.
pub trait Wire: Read + Write + Send {}
impl<T: Read + Write + Send> Wire for T {}
