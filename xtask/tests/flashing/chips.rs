//! The chips after the manuals, independent of xtask's table.

use std::ops::Range;

/// First address of the flash.
pub const FLASH: usize = 0x0800_0000;

/// A board, and requirements on its image.
#[derive(Clone)]
pub struct Chip {
    pub board: &'static str,
    /// probe-rs' name.
    pub name: &'static str,
    /// The USB loader's name of the flash.
    pub layout: &'static str,
    /// Flash sectors, KiB.
    pub sectors: &'static [usize],
    /// Interrupts, and those of the two levels.
    pub interrupts: usize,
    pub levels: [(&'static str, usize); 2],
    /// Where code may begin.
    pub text: u32,
    /// RAM for statics and the top of the stack.
    pub ram: u32,
    pub stack: u32,
    pub params: Option<Range<usize>>,
}

pub static F405: Chip = Chip {
    board: "f405",
    name: "STM32F405RGTx",
    layout: "@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg",
    sectors: &[16, 16, 16, 16, 64, 128, 128, 128, 128, 128, 128, 128],
    interrupts: 82,
    levels: [("CAN1_TX", 19), ("CAN2_TX", 63)],
    text: 0x0800_C000,
    ram: 0x2000_0000,
    stack: 0x1000_8000,
    params: Some(0x0800_4000..0x0800_C000),
};

pub static MATEK: Chip = Chip {
    board: "matek-h743",
    name: "STM32H743VITx",
    layout: "@Internal Flash   /0x08000000/16*128Kg",
    sectors: &[128; 16],
    interrupts: 150,
    levels: [("SAI3", 114), ("SAI4", 146)],
    text: 0x0800_0298,
    ram: 0x2400_0000,
    stack: 0x2000_8000,
    params: Some(0x081C_0000..0x0820_0000),
};

pub static CUAV: Chip = Chip {
    board: "cuav-v5",
    name: "STM32F765IITx",
    layout: "@Internal Flash  /0x08000000/04*032Kg,01*128Kg,07*256Kg",
    sectors: &[32, 32, 32, 32, 128, 256, 256, 256, 256, 256, 256, 256],
    interrupts: 110,
    levels: [("SAI1", 87), ("SAI2", 91)],
    text: 0x0800_01F8,
    ram: 0x2000_8000,
    stack: 0x2000_8000,
    params: None,
};

pub fn find(name: &str) -> &'static Chip {
    [&F405, &MATEK, &CUAV]
        .into_iter()
        .find(|chip| chip.board == name)
        .unwrap()
}

impl Chip {
    pub fn size(&self) -> usize {
        self.sectors.iter().sum::<usize>() * 1024
    }

    /// Sectors that hold any of `addresses`, as flash offsets.
    pub fn touched(&self, addresses: Range<usize>) -> Range<usize> {
        let (mut start, mut first, mut last) = (0, self.size(), 0);
        for kib in self.sectors {
            let end = start + kib * 1024;
            if start + FLASH < addresses.end && end + FLASH > addresses.start {
                (first, last) = (first.min(start), end);
            }
            start = end;
        }
        first..last
    }

    /// Another firmware without erased bytes, and stored parameters.
    pub fn used(&self) -> Vec<u8> {
        let mut flash: Vec<u8> = (0..self.size())
            .map(|at| (at * 7 + at / 251) as u8 & 0x7F)
            .collect();
        flash[..4].copy_from_slice(&self.stack.to_le_bytes());
        flash[4..8].copy_from_slice(&0x0800_0201u32.to_le_bytes());
        flash
    }
}
