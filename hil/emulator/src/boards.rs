//! The boards that can be emulated, and what their images may use.

/// Which of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The reference board, STM32H743.
    MatekH743,
    /// The custom board, STM32F405.
    F405,
}

/// One board.
#[derive(Debug)]
pub struct EmulatedBoard {
    /// Which it is.
    pub kind: Kind,
    /// Its name, everywhere.
    pub name: &'static str,
    /// Its processor.
    pub chip: &'static str,
    /// Flash: first address, and first one beyond.
    pub flash: (u64, u64),
    /// RAM that the stack may lie in.
    pub ram: &'static [(u64, u64)],
}

/// All of them, the reference board first.
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

/// The board called `name`.
///
/// # Errors
/// One line: the name and what is allowed.
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
