//! Line editor: assembles terminal bytes into lines, with echo.

use heapless::{String, Vec};

use super::keys::{CANCEL, CHUNK};

/// Longest line, characters.
pub(super) const LENGTH: usize = 80;
/// Echo of one chunk: at most three bytes for each.
pub(super) type Echo = Vec<u8, { 3 * CHUNK }>;

/// Why a line is rejected as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineError {
    /// More than [`LENGTH`] characters.
    TooLong,
    /// A byte above 127, or a control character. Dropping it silently would alter pasted text.
    NotText,
    /// Bytes were lost on the way.
    Damaged,
}

impl LineError {
    pub(super) const fn text(self) -> &'static str {
        match self {
            Self::TooLong => "line too long: 80 characters at most",
            Self::NotText => "only printable ASCII characters are understood",
            Self::Damaged => "the line was damaged on its way: type it again",
        }
    }
}

/// Position within a cursor key's bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Escape {
    #[default]
    None,
    Begun,
    Within,
}

#[derive(Default)]
pub(super) struct Line {
    text: String<LENGTH>,
    error: Option<LineError>,
    escape: Escape,
    after_cr: bool,
}

impl Line {
    /// Takes one byte; true if it ends the line (CR, LF, CR LF, or telnet's CR NUL). A tab is a blank. Cursor keys are
    /// ignored on an empty line and invalidate any other, since cursor movement is not supported.
    pub(super) fn push(&mut self, byte: u8, echo: &mut Echo) -> bool {
        let after_cr = core::mem::replace(&mut self.after_cr, byte == b'\r');
        match byte {
            b'\n' | 0 if after_cr => return false,
            b'\r' | b'\n' => {
                self.escape = Escape::None;
                return true;
            }
            CANCEL => {
                *self = Self::default();
                return false;
            }
            _ => (),
        }
        let byte = if byte == b'\t' { b' ' } else { byte };
        match (self.escape, byte) {
            (Escape::Begun, b'[' | b'O') => self.escape = Escape::Within,
            (Escape::Within, b' '..=b'?') => (),
            (Escape::Within, b'@'..=b'~') => self.escape = Escape::None,
            (Escape::None, 0x1B) => {
                self.escape = Escape::Begun;
                if !self.text.is_empty() {
                    self.spoil(LineError::NotText);
                }
            }
            (Escape::None, 0x08 | 0x7F) => {
                if self.text.pop().is_some() {
                    let _ = echo.extend_from_slice(b"\x08 \x08");
                }
            }
            (Escape::None, b' '..=b'~') => match self.text.push(char::from(byte)) {
                Ok(()) => {
                    let _ = echo.push(byte);
                }
                Err(_) => self.spoil(LineError::TooLong),
            },
            _ => {
                self.escape = Escape::None;
                self.spoil(LineError::NotText);
            }
        }
        false
    }

    /// Rejects the line; keeps the first reason.
    pub(super) fn spoil(&mut self, error: LineError) {
        self.error.get_or_insert(error);
    }

    /// Returns the finished line and starts a new one.
    pub(super) fn take(&mut self) -> Result<String<LENGTH>, LineError> {
        let text = core::mem::take(&mut self.text);
        match self.error.take() {
            Some(error) => Err(error),
            None => Ok(text),
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use std::string::String as Text;
    use std::vec::Vec as Many;

    use super::*;

    fn lines(bytes: &[u8]) -> (Many<Result<Text, LineError>>, Text) {
        let mut line = Line::default();
        let (mut lines, mut echoed) = (Many::new(), Text::new());
        for byte in bytes {
            let mut echo = Echo::new();
            if line.push(*byte, &mut echo) {
                lines.push(line.take().map(|l| Text::from(l.as_str())));
            }
            echoed.push_str(str::from_utf8(&echo).unwrap());
        }
        (lines, echoed)
    }

    fn ok(texts: &[&str]) -> Many<Result<Text, LineError>> {
        texts.iter().map(|t| Ok(Text::from(*t))).collect()
    }

    #[test]
    fn every_line_end_ends_one_line() {
        assert_eq!(
            lines(b"a\rb\nc\r\nd\n\re\r").0,
            ok(&["a", "b", "c", "d", "", "e"])
        );
    }

    #[test]
    fn a_line_can_be_corrected() {
        assert_eq!(
            lines(b"\x08helq\x7Fp\r"),
            (ok(&["help"]), "helq\x08 \x08p".into())
        );
        // Cursor keys leave nothing where nothing is typed yet.
        assert_eq!(lines(b"\x1B[A\x1B[1;5C\x1BOPsave\r").0, ok(&["save"]));
        assert_eq!(lines(b"\x1B[\rhelp\r").0, ok(&["", "help"]));
        assert_eq!(lines(b"a\r\0b\r\0").0, ok(&["a", "b"]));
        assert_eq!(
            lines(b"set infill\t10\r"),
            (ok(&["set infill 10"]), "set infill 10".into())
        );
        // Ctrl-C drops what was begun, whatever is wrong with it.
        assert_eq!(lines(b"sa\x03help\r\xE4\x03save\r").0, ok(&["help", "save"]));
    }

    #[test]
    fn no_byte_vanishes_from_a_line() {
        // What ends, drops, corrects or separates has its own tests.
        let others = (0..=255).filter(|byte| !b"\r\n\t\x03\x08\x7F".contains(byte));
        for byte in others {
            let typed = [b"set infill 7", &[byte][..], b".5\rok\r"].concat();
            let first = match byte {
                b' '..=b'~' => Ok(Text::from_utf8(typed[..15].to_vec()).unwrap()),
                _ => Err(LineError::NotText),
            };
            assert_eq!(lines(&typed).0, [first, Ok("ok".into())], "{byte:#x}");
        }
        for keys in [
            &b"\x1B[C"[..],
            b"\x1B[1;5C",
            b"\x1BOP",
            b"\x1B[",
            b"\x1B\x1B[A",
            b"\x1Bx",
        ] {
            let typed = [b"set infill 4", keys, b".5\rok\r"].concat();
            assert_eq!(
                lines(&typed).0,
                [Err(LineError::NotText), Ok("ok".into())],
                "{keys:?}"
            );
        }
        // A sequence that is none, at the start of a line.
        for keys in [&b"\x1Bx"[..], b"\x1B[\0A", b"\x1B[\xE4A", b"\x1B\x1B[A"] {
            let typed = [keys, b"save\rok\r"].concat();
            assert_eq!(
                lines(&typed).0,
                [Err(LineError::NotText), Ok("ok".into())],
                "{keys:?}"
            );
        }
    }

    #[test]
    fn a_bad_line_is_refused_as_a_whole_and_the_next_is_not() {
        let mut bytes = b"save".to_vec();
        bytes.extend([b' '; LENGTH]);
        bytes.extend(b"\rok\rs\xE4ve\rok\r");
        assert_eq!(
            lines(&bytes).0,
            [
                Err(LineError::TooLong),
                Ok("ok".into()),
                Err(LineError::NotText),
                Ok("ok".into())
            ]
        );
        let fits = [b'x'; LENGTH];
        assert_eq!(lines(&[&fits[..], b"\r"].concat()).0.len(), 1);
        assert!(lines(&[&fits[..], b"\r"].concat()).0.iter().all(Result::is_ok));
    }
}
