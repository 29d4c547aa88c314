//! Opening of a file that may be a named pipe.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::os::unix::fs::FileTypeExt;
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Longest wait for the writer of a named pipe: a program that was started at the same time opens it within that.
const WRITER_WAIT: Duration = Duration::from_secs(5);

/// Opens the file at `path`. A named pipe without a writer is an error after [`WRITER_WAIT`].
pub fn open(path: &Path) -> io::Result<File> {
    if !std::fs::metadata(path)?.file_type().is_fifo() {
        return File::open(path);
    }
    // Opening blocks until there is a writer, and the standard library cannot end that: a thread waits, and is left
    // behind if no writer comes.
    let (sender, opened) = mpsc::channel();
    let path = path.to_owned();
    thread::spawn(move || sender.send(File::open(path)));
    opened.recv_timeout(WRITER_WAIT).unwrap_or_else(|_| {
        Err(io::Error::new(
            ErrorKind::TimedOut,
            format!(
                "no program writes into this pipe within {} s",
                WRITER_WAIT.as_secs()
            ),
        ))
    })
}
