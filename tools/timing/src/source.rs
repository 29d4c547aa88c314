//! Messages of a file: text of `probe-rs run` or the bench, or a raw log.

use std::path::Path;

use defmt_decoder::{DecodeError, Table};

/// The messages of a capture.
#[derive(Debug)]
pub struct Messages {
    /// Each with its prefix.
    pub lines: Vec<String>,
    /// What was unreadable, in a sentence.
    pub broken: Option<String>,
}

/// Reads `capture`; `elf` is its image, needed only for raw logs.
///
/// # Errors
/// One line: what is wrong with either file and what is required.
pub fn read(capture: &Path, elf: Option<&Path>) -> Result<Messages, String> {
    let bytes = load(capture)?;
    let image = elf.map(load).transpose()?;
    let complaint = |what: String| format!("{}: {what}", capture.display());
    if bytes.is_empty() {
        return Err(complaint("is empty; wanted is a log".into()));
    }
    if is_text(&bytes) {
        return Ok(text(&bytes));
    }
    let (Some(elf), Some(image)) = (elf, image) else {
        return Err(complaint(
            "is no text: give the image that logged these bytes with --elf".into(),
        ));
    };
    let table = Table::parse(&image)
        .map_err(|e| format!("{}: its log cannot be decoded: {e}", elf.display()))?
        .ok_or_else(|| format!("{}: has no table of log messages (.defmt)", elf.display()))?;
    let messages = raw(&bytes, &table);
    if messages.lines.is_empty() {
        return Err(complaint(format!(
            "nothing in it was logged by {}",
            elf.display()
        )));
    }
    Ok(messages)
}

fn load(path: &Path) -> Result<Vec<u8>, String> {
    std::fs::read(path).map_err(|e| format!("{}: cannot be read: {e}", path.display()))
}

/// Line ends and no unprintable characters; the last character may be cut.
fn is_text(bytes: &[u8]) -> bool {
    let readable = match std::str::from_utf8(bytes) {
        Ok(_) => true,
        Err(e) => e.error_len().is_none(),
    };
    readable && !bytes.iter().any(|&b| b < 0x20 && !b"\n\r\t\x1b".contains(&b))
}

fn text(bytes: &[u8]) -> Messages {
    let text = String::from_utf8_lossy(bytes);
    let mut lines: Vec<String> = text.lines().map(plain).collect();
    // The last line may be cut within a number.
    let broken = (!text.ends_with('\n')).then(|| {
        lines.pop();
        "the last line is cut off".to_owned()
    });
    Messages { lines, broken }
}

fn plain(line: &str) -> String {
    let mut plain = String::new();
    let mut rest = line;
    while let Some((before, escape)) = rest.split_once("\x1b[") {
        plain += before;
        rest = escape.split_once('m').map_or("", |(_, after)| after);
    }
    plain + rest
}

fn raw(bytes: &[u8], table: &Table) -> Messages {
    let mut decoder = table.new_stream_decoder();
    decoder.received(bytes);
    let (mut lines, mut malformed) = (Vec::new(), 0u32);
    loop {
        match decoder.decode() {
            Ok(frame) => {
                let stamp = frame.display_timestamp().map_or(String::new(), |t| t.to_string());
                lines.push(format!("{stamp} {}", frame.display_message()));
            }
            Err(DecodeError::UnexpectedEof) => break,
            Err(DecodeError::Malformed) => {
                malformed += 1;
                if !table.encoding().can_recover() {
                    break;
                }
            }
        }
    }
    let strange = (malformed > 0).then(|| {
        format!(
            "{malformed} stretches are not of this image's log or were lost on the way; {} messages are left",
            lines.len()
        )
    });
    // Frames of a recoverable encoding end with a zero.
    let cut = (table.encoding().can_recover() && bytes.last() != Some(&0))
        .then(|| "the last message is cut off".to_owned());
    let faults: Vec<String> = strange.into_iter().chain(cut).collect();
    let broken = (!faults.is_empty()).then(|| faults.join(", "));
    Messages { lines, broken }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_line_is_left_out_and_told() {
        let messages = text(b"1.0 INFO a\r\n2.0 INFO 12");
        assert_eq!(messages.lines, ["1.0 INFO a"]);
        assert!(messages.broken.is_some());
        assert!(text(b"1.0 INFO a\n").broken.is_none());
    }

    #[test]
    fn colours_are_taken_out() {
        assert_eq!(plain("\x1b[32mINFO\x1b[0m timing"), "INFO timing");
    }

    #[test]
    fn bytes_are_no_text() {
        assert!(is_text("0.1 INFO µs\n".as_bytes()));
        assert!(is_text(&"0.1 µ".as_bytes()[..5]));
        assert!(!is_text(&[0x00, 0x12, 0xff]));
    }
}
