//! Board data for builds and checks.

/// All chips.
pub const FLASH: u64 = 0x0800_0000;

/// Consecutive equal sectors.
#[derive(Clone, Copy, Debug)]
pub struct Sectors {
    pub count: u64,
    /// Bytes of each.
    pub size: u64,
}

/// A memory of the chip.
#[derive(Clone, Copy, Debug)]
pub struct Bank {
    /// First address.
    pub start: u64,
    pub end: u64,
}

/// The chip maker's USB loader.
#[derive(Clone, Copy)]
pub enum UsbLoader {
    /// How to enter it.
    Enter(&'static str),
    /// The same, where this firmware alone enters it: nothing else does on this board.
    ByFirmware(&'static str),
}

#[derive(Clone, Copy)]
pub struct Board {
    /// Name, also the cargo feature.
    pub name: &'static str,
    /// Chip name of probe-rs.
    pub probe_rs_chip: &'static str,
    /// Core, for specific code; the plain target is built for an M4F.
    pub core: &'static str,
    pub interrupts: usize,
    /// Vectors of the flight and steady level.
    pub levels: [&'static str; 2],
    /// Flash sectors from [`FLASH`] on.
    pub flash: &'static [Sectors],
    /// The chip's own loader, without a probe.
    pub usb_loader: UsbLoader,
    /// Memories for data.
    pub banks: &'static [Bank],
    /// Memories of DMA1 and DMA2: first address and end.
    pub dma_reaches: &'static [(u64, u64)],
    /// Memory retained across resets: first address and end.
    pub retained: (u64, u64),
    /// Flies with the data cache off; another image has it on.
    pub data_cache_is_optional: bool,
}

/// Every board, the reference board first.
pub const BOARDS: [Board; 3] = [
    Board {
        name: "matek-h743",
        probe_rs_chip: "STM32H743VITx",
        core: "cortex-m7",
        interrupts: 150,
        levels: ["SAI3", "SAI4"],
        // Two banks (RM0433 §4.3.4).
        flash: &[sectors(16, 128)],
        // BOOT0 has a button; USB is on PA11 and PA12, which the loader uses (AN2606).
        usb_loader: UsbLoader::Enter(
            "type `dfu` at its console, or hold its button BOOT while plugging USB in",
        ),
        // DTCM, AXI SRAM, SRAM1 to SRAM3, SRAM4 (RM0433 §2.3).
        banks: &[
            bank(0x2000_0000, 128),
            bank(0x2400_0000, 512),
            bank(0x3000_0000, 288),
            bank(0x3800_0000, 64),
        ],
        // AXI SRAM, SRAM1 to SRAM3 (RM0433 §2.1); not the tightly coupled memories.
        dma_reaches: &[(0x2400_0000, 0x2408_0000), (0x3000_0000, 0x3004_8000)],
        // DTCM: its error correction works on 32-bit words, as written.
        retained: (0x2001_FC00, 0x2002_0000),
        data_cache_is_optional: true,
    },
    Board {
        name: "cuav-v5",
        probe_rs_chip: "STM32F765IITx",
        core: "cortex-m7",
        interrupts: 110,
        levels: ["SAI1", "SAI2"],
        // One bank (RM0410 §3.3.2), as in `boards/memory/cuav-v5.x`.
        flash: &[sectors(4, 32), sectors(1, 128), sectors(7, 256)],
        // FMUv5 is flashed over USB by a loader in flash: it has no button for BOOT0, and its case leads the pin nowhere.
        usb_loader: UsbLoader::ByFirmware("type `dfu` at its console, where this firmware runs by a probe"),
        // DTCM, SRAM1 and SRAM2 (RM0410 §2.3).
        banks: &[bank(0x2000_0000, 128), bank(0x2002_0000, 384)],
        // DTCM, never cached; the data cache is on and caches the DMA's other memories, SRAM1 and SRAM2 (RM0410 §2.1).
        dma_reaches: &[(0x2000_0000, 0x2002_0000)],
        // DTCM.
        retained: (0x2001_FC00, 0x2002_0000),
        data_cache_is_optional: false,
    },
    Board {
        name: "f405",
        probe_rs_chip: "STM32F405RGTx",
        core: "cortex-m4",
        interrupts: 82,
        levels: ["CAN1_TX", "CAN2_TX"],
        // RM0090 §3.3.
        flash: &[sectors(4, 16), sectors(1, 64), sectors(7, 128)],
        // PA11 and PA12 are free for USB, BOOT0 for a button.
        usb_loader: UsbLoader::Enter(
            "type `dfu` at its console, or take BOOT0 to 3.3 V while plugging USB (PA11, PA12) in",
        ),
        // Core-coupled memory; SRAM1 and SRAM2 (RM0090 §2.3.1).
        banks: &[bank(0x1000_0000, 64), bank(0x2000_0000, 128)],
        // SRAM1 and SRAM2 (RM0090 §2.1), not the core-coupled memory.
        dma_reaches: &[(0x2000_0000, 0x2002_0000)],
        // SRAM2's end.
        retained: (0x2001_FC00, 0x2002_0000),
        data_cache_is_optional: false,
    },
];

const fn sectors(count: u64, kib: u64) -> Sectors {
    Sectors {
        count,
        size: kib * 1024,
    }
}

const fn bank(start: u64, kib: u64) -> Bank {
    Bank {
        start,
        end: start + kib * 1024,
    }
}

impl Board {
    pub fn flash_size(&self) -> u64 {
        self.flash.iter().map(|equal| equal.count * equal.size).sum()
    }
}

pub fn find(name: &str) -> Option<&'static Board> {
    BOARDS.iter().find(|b| b.name == name)
}

pub fn names() -> String {
    BOARDS.map(|b| b.name).join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flash_is_as_large_as_its_chip_is_called() {
        for (name, kib) in [("matek-h743", 2048), ("cuav-v5", 2048), ("f405", 1024)] {
            assert_eq!(find(name).map(Board::flash_size), Some(kib * 1024), "{name}");
        }
    }
}
