//! Identifies other flight stacks' data: on a board used before they lie in the same sectors or FRAM.

pub(super) const HEAD: usize = 16;

/// AP_FlashStorage's mark: 24 bits after a byte of state in an F4's sector, 32 after a word of state in an H7's.
const ARDUPILOT_F4: [u8; 3] = [0x5B, 0x68, 0x51];
const ARDUPILOT_H7: [u8; 4] = [0x62, 0x5B, 0x68, 0x51];
/// AP_Param's header in an FRAM: "PA" and format revision.
const ARDUPILOT_FRAM: [u8; 4] = [0x50, 0x41, 6, 0];
/// Second byte of Betaflight's and INAV's configuration, after the format version.
const BETAFLIGHT: u8 = 0xBE;
/// Mark of PX4's parameters in flash.
const PX4_FLASH: [u8; 4] = [0xC3, 0x3C, 0x55, 0xAA];
/// First entry's types, 64-bit float and 32-bit integer: PX4's parameters in an FRAM are a BSON document with names in
/// capitals.
const BSON_TYPES: [u8; 2] = [0x01, 0x10];

/// Owner of a page beginning with `head`; `None` for a blank, own or unknown page.
pub(super) fn owner(head: &[u8; HEAD]) -> Option<&'static str> {
    match *head {
        [_, a, b, c, ..] if [a, b, c] == ARDUPILOT_F4 => Some("ArduPilot"),
        [_, _, _, _, a, b, c, d, ..] if [a, b, c, d] == ARDUPILOT_H7 => Some("ArduPilot"),
        [a, b, c, d, ..] if [a, b, c, d] == ARDUPILOT_FRAM => Some("ArduPilot"),
        [a, b, c, d, ..] if [a, b, c, d] == PX4_FLASH => Some("PX4"),
        // Document length (0 in older ones), then type and name of the first entry.
        [_, _, _, 0, kind, ref name @ ..] if BSON_TYPES.contains(&kind) && capitals(name) => Some("PX4"),
        // Version, mark, then the length of the first record, with at least 6 bytes of head.
        [100..=250, BETAFLIGHT, 6..=255, 0..=0x0F, ..] => Some("Betaflight"),
        _ => None,
    }
}

/// Start of a PX4 parameter's name such as `SYS_AUTOSTART`, three characters or more.
fn capitals(name: &[u8]) -> bool {
    let length = name.iter().position(|byte| *byte == 0).unwrap_or(name.len());
    let letter = |byte: &u8| byte.is_ascii_uppercase() || byte.is_ascii_digit() || *byte == b'_';
    length >= 3 && name.iter().take(length).all(letter)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(bytes: &[u8]) -> [u8; HEAD] {
        let mut head = [0xFF; HEAD];
        head[..bytes.len()].copy_from_slice(bytes);
        head
    }

    #[test]
    fn each_stack_is_known_by_its_beginning() {
        let known: [(&[u8], &str); 6] = [
            // F4 sector in use: state 0xFE or 0xFC below 0x51685B.
            (&[0xFC, 0x5B, 0x68, 0x51, 0x00], "ArduPilot"),
            // H7: state, then the signature 0x51685B62.
            (&[0xF1, 0x99, 0x0D, 0x21, 0x62, 0x5B, 0x68, 0x51], "ArduPilot"),
            (&[0x50, 0x41, 0x06, 0x00, 0x12, 0x34], "ArduPilot"),
            (&[0xB0, 0xBE, 0x2A, 0x00, 0x0B, 0x00], "Betaflight"),
            (b"\x00\x00\x00\x00\x10SYS_AUTOSTA", "PX4"),
            (&[0xC3, 0x3C, 0x55, 0xAA], "PX4"),
        ];
        for (bytes, stack) in known {
            assert_eq!(owner(&page(bytes)), Some(stack), "{bytes:02x?}");
        }
    }

    #[test]
    fn blank_own_and_noise_belong_to_nobody() {
        let noise: [u8; HEAD] = core::array::from_fn(|n| (n as u8).wrapping_mul(37) ^ 0x5A);
        for head in [[0xFF; HEAD], [0; HEAD], noise, page(b"\x00\x00\x00\x00SPH1")] {
            assert_eq!(owner(&head), None, "{head:02x?}");
        }
    }
}
