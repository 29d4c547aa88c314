//! The key that signs MAVLink, from a file: on a command line everyone would read it.

use std::fs;
use std::path::Path;

use sophie_sim::live::Key;

/// The key in `file`.
pub fn read(file: &Path) -> Result<Key, String> {
    let text =
        fs::read_to_string(file).map_err(|why| format!("{}: cannot be read: {why}", file.display()))?;
    Key::from_hex(text.trim()).ok_or_else(|| {
        let (shown, digits) = (file.display(), Key::DIGITS);
        format!("{shown}: no key: {digits} hexadecimal digits are expected")
    })
}
