//! Messages of a file: text of `probe-rs run` or the bench, or a raw log.

use std::borrow::Cow;
use std::path::Path;

use defmt_decoder::{DecodeError, Table};
use sophie_input::MIB;

/// Bytes of the longest log: some days of text.
const LOG_MAX: u64 = 256 * MIB;
/// Bytes of the largest image, with its debug information.
const IMAGE_MAX: u64 = 256 * MIB;
/// Unreadable bytes for each byte of a text with line noise: one a line or so, beyond which few lines would be left. A log's
/// own bytes have far more: every frame ends with a zero.
const NOISE_MAX: f64 = 0.01;

/// The messages of a capture.
#[derive(Debug)]
pub struct Messages {
    /// Each with its prefix.
    pub lines: Vec<String>,
    /// The unreadable part, in a sentence.
    pub broken: Option<String>,
    /// The text's encoding, if it is unusual.
    pub encoding: Option<&'static str>,
}

/// Reads `capture`; `elf` is its image, needed only for raw logs.
///
/// # Errors
/// One line: the defect of a file, and the required format.
pub fn read(capture: &Path, elf: Option<&Path>) -> Result<Messages, String> {
    let bytes = load(capture, LOG_MAX)?;
    let image = elf.map(|elf| load(elf, IMAGE_MAX)).transpose()?;
    let complaint = |what: String| format!("{}: {what}", capture.display());
    if bytes.is_empty() {
        return Err(complaint("is empty; wanted is a log".into()));
    }
    if let Some(decoded) = utf16(&bytes) {
        return Ok(Messages {
            encoding: Some("UTF-16 text, as PowerShell's > writes it"),
            ..text(&decoded)
        });
    }
    if let Some(decoded) = utf8(&bytes) {
        return Ok(text(&decoded));
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

fn load(path: &Path, most: u64) -> Result<Vec<u8>, String> {
    sophie_input::read(path, most).map_err(|why| format!("{}: cannot be read: {why}", path.display()))
}

/// Text in UTF-8, where at most [`NOISE_MAX`] of it is unreadable; the last character may be cut.
fn utf8(bytes: &[u8]) -> Option<Cow<'_, str>> {
    let text = match std::str::from_utf8(bytes) {
        Err(e) if e.error_len().is_none() => String::from_utf8_lossy(bytes.get(..e.valid_up_to())?),
        _ => String::from_utf8_lossy(bytes),
    };
    let noise = text.chars().filter(|&c| unreadable(c)).count();
    (noise as f64 <= NOISE_MAX * bytes.len() as f64).then_some(text)
}

/// Text in UTF-16 behind its byte order mark.
fn utf16(bytes: &[u8]) -> Option<String> {
    let (mark, words) = bytes.split_first_chunk()?;
    let word: fn([u8; 2]) -> u16 = match mark {
        [0xff, 0xfe] => u16::from_le_bytes,
        [0xfe, 0xff] => u16::from_be_bytes,
        _ => return None,
    };
    let words = words.as_chunks().0.iter().map(|&w| word(w));
    let text: String = char::decode_utf16(words)
        .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect();
    let noise = text.chars().filter(|&c| unreadable(c)).count();
    (noise as f64 <= NOISE_MAX * text.len() as f64).then_some(text)
}

/// Neither printable, nor a line end, a tab or the beginning of a colour.
fn unreadable(c: char) -> bool {
    c == char::REPLACEMENT_CHARACTER || c.is_control() && !"\n\r\t\x1b".contains(c)
}

fn text(text: &str) -> Messages {
    let mut lines: Vec<&str> = text.lines().collect();
    let mut faults = Vec::new();
    // The last line may be cut within a number.
    if !text.ends_with('\n') {
        lines.pop();
        faults.push("the last line is cut off".to_owned());
    }
    let whole = lines.len();
    lines.retain(|line| !line.contains(unreadable));
    match whole - lines.len() {
        0 => {}
        1 => faults.push("a line with unreadable bytes is left out".to_owned()),
        noisy => faults.push(format!("{noisy} lines with unreadable bytes are left out")),
    }
    Messages {
        lines: lines.into_iter().map(plain).collect(),
        broken: (!faults.is_empty()).then(|| faults.join(", ")),
        encoding: None,
    }
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
    Messages {
        lines,
        broken,
        encoding: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_line_is_left_out_and_told() {
        let messages = text("1.0 INFO a\r\n2.0 INFO 12");
        assert_eq!(messages.lines, ["1.0 INFO a"]);
        assert!(messages.broken.is_some());
        assert!(text("1.0 INFO a\n").broken.is_none());
    }

    #[test]
    fn colours_are_taken_out() {
        assert_eq!(plain("\x1b[32mINFO\x1b[0m timing"), "INFO timing");
    }

    #[test]
    fn bytes_are_no_text() {
        assert!(utf8("0.1 INFO µs\n".as_bytes()).is_some());
        assert!(utf8(&"0.1 µ".as_bytes()[..5]).is_some());
        assert!(utf8(&[0x00, 0x12, 0xff]).is_none());
    }

    #[test]
    fn line_noise_costs_its_lines_alone() {
        let mut log: Vec<u8> = (0..100)
            .flat_map(|n| format!("{n}.0 INFO line\n").into_bytes())
            .collect();
        log[60] = 0xff;
        log[200..202].copy_from_slice(b"\x00\x80");
        let messages = text(&utf8(&log).unwrap());
        assert_eq!(messages.lines.len(), 98);
        assert_eq!(
            messages.broken.as_deref(),
            Some("2 lines with unreadable bytes are left out")
        );
    }

    #[test]
    fn what_powershell_writes_is_decoded() {
        for (mark, bytes) in [
            ([0xff, 0xfe], u16::to_le_bytes as fn(u16) -> [u8; 2]),
            ([0xfe, 0xff], u16::to_be_bytes),
        ] {
            let words = "0.1 INFO µs\r\n".encode_utf16().flat_map(bytes);
            let file: Vec<u8> = mark.into_iter().chain(words).collect();
            assert_eq!(utf16(&file).as_deref(), Some("0.1 INFO µs\r\n"));
        }
        assert_eq!(utf16(b"0.1 INFO"), None);
    }
}
