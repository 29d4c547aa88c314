//! Bytes to and from a board, whatever carries them.

use std::io::{Read, Write};

/// Both directions of a line. A read of a silent line returns [`TimedOut`](std::io::ErrorKind::TimedOut) or
/// [`WouldBlock`](std::io::ErrorKind::WouldBlock) within some milliseconds.
pub trait Wire: Read + Write + Send {}
impl<T: Read + Write + Send> Wire for T {}
