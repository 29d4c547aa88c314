//! The list of emulated boards and the memory that each gives its image.

/// Board type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Reference board, STM32H743.
    MatekH743,
    /// Custom board, STM32F405.
    F405,
}

/// A board.
#[derive(Debug)]
pub struct EmulatedBoard {
    /// Type.
    pub kind: Kind,
    /// Name.
    pub name: &'static str,
    /// Processor.
    pub chip: &'static str,
    /// Flash: first address and end.
    pub flash: (u64, u64),
    /// RAM permitted for the stack.
    pub ram: &'static [(u64, u64)],
}

/// All boards, the reference board first.
pub static BOARDS: [EmulatedBoard; 2] = [
    EmulatedBoard {
        kind: Kind::MatekH743,
        name: "matek-h743",
        chip: "STM32H743",
        flash: (0x0800_0000, 0x0820_0000),
        // DTCM, AXI SRAM.
        ram: &[(0x2000_0000, 0x2002_0000), (0x2400_0000, 0x2408_0000)],
    },
    EmulatedBoard {
        kind: Kind::F405,
        name: "f405",
        chip: "STM32F405",
        flash: (0x0800_0000, 0x0810_0000),
        // Core-coupled memory, SRAM1 and SRAM2.
        ram: &[(0x1000_0000, 0x1001_0000), (0x2000_0000, 0x2002_0000)],
    },
];

/// The board `name`.
///
/// # Errors
/// One line: the name, and the permitted ones.
pub fn find(name: &str) -> Result<&'static EmulatedBoard, String> {
    BOARDS.iter().find(|board| board.name == name).ok_or_else(|| {
        let names = BOARDS.each_ref().map(|board| board.name).join(", ");
        format!("no board called `{name}` is emulated: allowed is {names}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_board_is_found_by_its_name() {
        assert_eq!(find("f405").unwrap().kind, Kind::F405);
        assert!(
            find("cuav-v5")
                .unwrap_err()
                .contains("allowed is matek-h743, f405")
        );
    }
}
