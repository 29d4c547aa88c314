//! The files for ground stations: the description of the parameters (MAVLink's component metadata).
//!
//! `tests/mavlink/metadata.rs` prints them from the table of parameters.

/// A file.
#[derive(Debug, PartialEq, Eq)]
pub struct File {
    /// Its path below the root.
    pub path: &'static str,
    /// Its content.
    pub bytes: &'static [u8],
}

/// The list of the metadata files.
pub const GENERAL: File = File {
    path: "general.json",
    bytes: include_bytes!("../../files/general.json"),
};
/// Names, units, ranges, choices and texts of all parameters, compressed: 20 KB would be too much for the smallest board.
pub const PARAMETER: File = File {
    path: "parameter.json.xz",
    bytes: include_bytes!("../../files/parameter.json.xz"),
};
/// All files.
pub static FILES: [File; 2] = [GENERAL, PARAMETER];
/// Address of the list; COMPONENT_METADATA sends it.
pub const GENERAL_URI: &str = "mftp:///general.json";
/// Checksum of the file at [`GENERAL_URI`].
pub const GENERAL_CRC: u32 = crc32(GENERAL.bytes);

/// MAVLink's checksum of a file: the reflected polynomial 0xEDB88320 from 0, not inverted at the end.
pub const fn crc32(bytes: &[u8]) -> u32 {
    let mut crc = 0;
    let mut rest = bytes;
    while let [byte, tail @ ..] = rest {
        crc ^= *byte as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg());
            bit += 1;
        }
        rest = tail;
    }
    crc
}
