//! Reads the key that signs MAVLink from a file: on a command line other users could read it.

use std::path::Path;

use sophie_sim::live::Key;

/// Largest size of a key file, bytes: its digits and white space around them.
const MAX_BYTES: u64 = 4096;

/// The key in `file`.
pub fn read(file: &Path) -> Result<Key, String> {
    let text = sophie_input::read_text(file, MAX_BYTES)
        .map_err(|why| format!("{}: cannot be read: {why}", file.display()))?;
    Key::from_hex(text.trim()).ok_or_else(|| {
        let (shown, digits) = (file.display(), Key::DIGITS);
        format!("{shown}: no key: {digits} hexadecimal digits are expected")
    })
}
