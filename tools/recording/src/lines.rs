//! The lines of a file, plain or gzipped, bounded in length and number.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use flate2::read::MultiGzDecoder;

/// First bytes of a gzipped file (RFC 1952).
const GZIP: [u8; 2] = [0x1F, 0x8B];
/// Longest line, bytes: twenty times one of the format. A binary file ends here.
const LINE_MAX: u64 = 2_048;
/// Most lines: three hours at 1 kHz with all else. A small file can unpack to any length.
const LINES_MAX: usize = 20_000_000;

/// Lines with their numbers, without comments and empty ones.
pub struct Lines {
    name: String,
    input: Box<dyn BufRead>,
    number: usize,
    line: Vec<u8>,
    /// The next call gives the last line once more.
    again: bool,
}

impl Lines {
    /// Opens a file.
    ///
    /// # Errors
    /// One line: which file, and why it cannot be read.
    pub fn open(path: &Path) -> Result<Self, String> {
        let name = path.display().to_string();
        let refused = |e: std::io::Error| format!("{name}: cannot be read: {e}");
        if path.is_dir() {
            return Err(format!(
                "{name}: is a directory, allowed is a file, plain or gzipped"
            ));
        }
        let mut file = BufReader::new(sophie_input::open(path).map_err(refused)?);
        let packed = file.fill_buf().map_err(refused)?.starts_with(&GZIP);
        let input: Box<dyn BufRead> = if packed {
            Box::new(BufReader::new(MultiGzDecoder::new(file)))
        } else {
            Box::new(file)
        };
        Ok(Self {
            name,
            input,
            number: 0,
            line: vec![],
            again: false,
        })
    }

    /// The next line that is neither empty nor a comment, without blanks around it; `None` at the end.
    ///
    /// # Errors
    /// One line: the place where the file cannot be read, and the reason.
    pub fn next(&mut self) -> Result<Option<&str>, String> {
        while !std::mem::take(&mut self.again) {
            self.line.clear();
            self.number += 1;
            let mut bounded = (&mut self.input).take(LINE_MAX);
            let read = bounded.read_until(b'\n', &mut self.line);
            let count = read.map_err(|e| self.bad(&format!("cannot be read on: {e}")))?;
            if count == 0 {
                return Ok(None);
            }
            if self.number > LINES_MAX {
                return Err(self.bad(&format!("more than {LINES_MAX} lines, allowed are as many")));
            }
            if count as u64 == LINE_MAX {
                return Err(self.bad(&format!("a line of {LINE_MAX} bytes, allowed are fewer")));
            }
            let text = std::str::from_utf8(&self.line);
            let text = text.map_err(|_| self.bad("no text, allowed is text or gzipped text"))?;
            // Borrowed from the field again below: a loop cannot return a line that it may overwrite.
            if !matches!(text.trim().as_bytes().first(), None | Some(b'#')) {
                break;
            }
        }
        Ok(std::str::from_utf8(&self.line).ok().map(str::trim))
    }

    /// Has [`Self::next`] give the last line once more.
    pub const fn again(&mut self) {
        self.again = true;
    }

    /// A complaint about the last line.
    pub fn bad(&self, what: &str) -> String {
        format!("{}:{}: {what}", self.name, self.number)
    }

    /// A complaint about the file.
    pub fn whole(&self, what: &str) -> String {
        format!("{}: {what}", self.name)
    }
}

/// Latest time of a recording, µs: thirty years.
pub const TIME_MAX: u64 = 1_000_000_000_000_000;

/// A time.
pub fn time(name: &str, text: &str) -> Result<u64, String> {
    let value = text.parse().ok().filter(|t| *t <= TIME_MAX);
    value.ok_or_else(|| format!("{name} '{}', allowed 0 to {TIME_MAX} us, whole", short(text)))
}

/// A number within `least` and `most`, in `unit`.
pub fn number(name: &str, text: &str, (least, most): (f32, f32), unit: &str) -> Result<f32, String> {
    let value = text.parse().ok().filter(|v| (least..=most).contains(v));
    value.ok_or_else(|| format!("{name} '{}', allowed {least} to {most} {unit}", short(text)))
}

/// A value, cut for a message.
pub fn short(text: &str) -> String {
    text.chars()
        .take(40)
        .map(|c| if c.is_control() { '?' } else { c })
        .collect()
}
