//! The boards, as far as a build has to know them.

/// One board.
#[derive(Clone, Copy)]
pub struct Board {
    /// Name, which is also its cargo feature.
    pub name: &'static str,
    /// Chip, as probe-rs knows it.
    pub probe_rs_chip: &'static str,
    /// Core, for code that uses all of it. The plain target is built for an M4F.
    pub core: &'static str,
    /// Interrupts of the chip.
    pub interrupts: usize,
    /// Vectors of the flight and the steady level.
    pub levels: [&'static str; 2],
    /// Memories that DMA1 and DMA2 reach: first address, and first one beyond.
    pub dma_reaches: &'static [(u64, u64)],
}

/// Every board, the reference board first.
pub const BOARDS: [Board; 3] = [
    Board {
        name: "matek-h743",
        probe_rs_chip: "STM32H743VITx",
        core: "cortex-m7",
        interrupts: 150,
        levels: ["SAI3", "SAI4"],
        // AXI SRAM, SRAM1 to SRAM3 (RM0433 §2.1); not the tightly coupled memories.
        dma_reaches: &[(0x2400_0000, 0x2408_0000), (0x3000_0000, 0x3004_8000)],
    },
    Board {
        name: "cuav-v5",
        probe_rs_chip: "STM32F765IITx",
        core: "cortex-m7",
        interrupts: 110,
        levels: ["SAI1", "SAI2"],
        // DTCM, SRAM1 and SRAM2 (RM0410 §2.1).
        dma_reaches: &[(0x2000_0000, 0x2008_0000)],
    },
    Board {
        name: "f405",
        probe_rs_chip: "STM32F405RGTx",
        core: "cortex-m4",
        interrupts: 82,
        levels: ["CAN1_TX", "CAN2_TX"],
        // SRAM1 and SRAM2 (RM0090 §2.1); not the core-coupled memory.
        dma_reaches: &[(0x2000_0000, 0x2002_0000)],
    },
];

/// The board called `name`; `None` when there is none.
pub fn find(name: &str) -> Option<&'static Board> {
    BOARDS.iter().find(|b| b.name == name)
}

/// The boards' names, for a sentence.
pub fn names() -> String {
    BOARDS.map(|b| b.name).join(", ")
}
