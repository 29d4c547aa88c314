//! Files named on a command line, read up to a bound: an endless device or pipe gives a message and does not fill the
//! memory.

#![deny(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing
)]

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

#[cfg(unix)]
mod fifo;

/// Bytes of a MiB.
pub const MIB: u64 = 1 << 20;

/// The bytes of the file at `path`, at most `most`.
///
/// # Errors
/// The reason, without the file's name: the system's, a directory, or more than `most` bytes.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    // Opening a directory succeeds on some systems, and reading it then fails with a number.
    if path.is_dir() {
        return Err("it is a directory".to_owned());
    }
    let file = open(path).map_err(|error| error.to_string())?;
    let mut bytes = Vec::new();
    file.take(most.saturating_add(1))
        .read_to_end(&mut bytes)
        .map_err(|error| error.to_string())?;
    if bytes.len() as u64 > most {
        return Err(format!("it is longer than {}", size(most)));
    }
    Ok(bytes)
}

/// The text of the file at `path`, at most `most` bytes of UTF-8.
///
/// # Errors
/// As [`read`], or the text is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String, String> {
    String::from_utf8(read(path, most)?).map_err(|_| "it is not text in UTF-8".to_owned())
}

/// Opens the file at `path` for a reader with a bound of its own.
///
/// # Errors
/// Why it cannot be opened: the system's reason, or a named pipe that no program writes into.
pub fn open(path: &Path) -> io::Result<File> {
    #[cfg(unix)]
    return fifo::open(path);
    #[cfg(not(unix))]
    return File::open(path);
}

/// A bound, as text for messages.
fn size(bytes: u64) -> String {
    if bytes >= MIB {
        format!("{} MiB", bytes / MIB)
    } else {
        format!("{bytes} bytes")
    }
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn file(name: &str, content: &[u8]) -> std::path::PathBuf {
        let path = std::env::temp_dir().join(format!("sophie-input-{}-{name}", std::process::id()));
        std::fs::write(&path, content).unwrap();
        path
    }

    #[test]
    fn a_file_is_read_up_to_its_bound_and_refused_beyond() {
        let path = file("bound", b"12345");
        assert_eq!(read(&path, 5).unwrap(), b"12345");
        assert_eq!(read(&path, 4).unwrap_err(), "it is longer than 4 bytes");
        std::fs::remove_file(path).unwrap();
        assert_eq!(read(&std::env::temp_dir(), 4).unwrap_err(), "it is a directory");
        assert!(read(Path::new("/nowhere/at/all"), 4).is_err());
    }

    #[test]
    fn bytes_that_are_no_text_are_refused() {
        let path = file("text", b"\xff\xfea");
        assert_eq!(read_text(&path, MIB).unwrap_err(), "it is not text in UTF-8");
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    #[cfg(unix)]
    fn a_device_without_an_end_is_refused() {
        assert_eq!(
            read(Path::new("/dev/zero"), MIB).unwrap_err(),
            "it is longer than 1 MiB"
        );
        assert_eq!(read(Path::new("/dev/null"), MIB).unwrap(), b"");
    }

    #[cfg(unix)]
    fn fifo(name: &str) -> std::path::PathBuf {
        let path = file(name, b"");
        std::fs::remove_file(&path).unwrap();
        let made = std::process::Command::new("mkfifo").arg(&path).status().unwrap();
        assert!(made.success());
        path
    }

    #[test]
    #[cfg(unix)]
    fn a_pipe_is_read() {
        let path = fifo("written");
        let to = path.clone();
        let writer = std::thread::spawn(move || std::fs::write(to, b"from a pipe").unwrap());
        assert_eq!(read(&path, MIB).unwrap(), b"from a pipe");
        writer.join().unwrap();
        std::fs::remove_file(path).unwrap();
    }

    #[test]
    #[cfg(unix)]
    fn a_pipe_without_a_writer_is_given_up() {
        let path = fifo("unwritten");
        let begun = Instant::now();
        let why = read(&path, MIB).unwrap_err();
        std::fs::remove_file(path).unwrap();
        assert!(why.contains("no program writes into this pipe"), "{why}");
        assert!(begun.elapsed() < Duration::from_secs(30));
    }
}
