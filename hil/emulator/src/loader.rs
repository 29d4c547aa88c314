//! Loaders: one that jumps to the firmware with its own vector table active, as the chip's USB loader does, and one in that
//! loader's place.

use object::{Object, ObjectSection};

use crate::board_kind::Kind;
use crate::elf::{Firmware, Loader};

/// Flash of every emulated chip outside firmware and parameters.
const AT: u32 = 0x080E_0000;
/// Words of the vector table: a power of two, more than any chip's.
const VECTORS: u32 = 256;
/// Vector table offset register (ARMv7-M, B3.2.5).
const VTOR: u32 = 0xE000_ED08;

impl Firmware {
    /// Puts a loader where the chip's own is. It starts the firmware again, without a reset, if its vector table is active;
    /// otherwise it stands still.
    ///
    /// # Errors
    /// One line: the image has no vector table.
    pub fn with_the_chips_loader(&mut self) -> Result<(), String> {
        let at: u32 = match self.board.kind {
            Kind::F405 => 0x1FFF_0000,
            Kind::MatekH743 => 0x1FF0_9800,
        };
        let file = object::File::parse(&*self.bytes).map_err(|e| e.to_string())?;
        let table = file.section_by_name(".vector_table");
        let table = table.and_then(|s| s.data().ok()?.first_chunk::<8>().copied());
        let [a, b, c, d, e, f, g, h] = table.ok_or("the image has no vector table")?;
        let [stack, firmware] = [[a, b, c, d], [e, f, g, h]].map(u32::from_le_bytes);
        // ldr r0, =VTOR; ldr r1, [r0]; ldr r2, =at; cmp r1, r2; bne .; ldr r3, =firmware; bx r3; nop
        let code: [u16; 8] = [0x4803, 0x6801, 0x4A03, 0x4291, 0xD1FE, 0x4B03, 0x4718, 0xBF00];
        let mut bytes: Vec<u8> = [stack, (at + 8) | 1]
            .into_iter()
            .flat_map(u32::to_le_bytes)
            .collect();
        bytes.extend(code.iter().flat_map(|half| half.to_le_bytes()));
        bytes.extend([VTOR, at, firmware].iter().flat_map(|word| word.to_le_bytes()));
        self.loader = Some(Loader { at: at.into(), bytes });
        Ok(())
    }

    /// Puts a loader, whose vectors all lead to an endless loop, before the firmware.
    ///
    /// # Errors
    /// One line: the image has no vector table.
    pub fn behind_a_loader(&mut self) -> Result<(), String> {
        let file = object::File::parse(&*self.bytes).map_err(|e| e.to_string())?;
        let table = file.section_by_name(".vector_table").and_then(|s| s.file_range());
        let (offset, _) = table.ok_or("the image has no vector table")?;
        let reset = offset as usize + 4..offset as usize + 8;
        let vector = self.bytes.get_mut(reset).ok_or("the image is cut short")?;
        let firmware = u32::from_le_bytes(std::array::from_fn(|n| vector[n]));

        let trap = AT + 4 * VECTORS;
        let [looping, entry] = [trap | 1, (trap + 4) | 1];
        vector.copy_from_slice(&entry.to_le_bytes());
        let mut bytes: Vec<u8> = (0..VECTORS).flat_map(|_| looping.to_le_bytes()).collect();
        // b .; nop; ldr r0, =VTOR; ldr r1, =AT; str r1, [r0]; ldr r0, =firmware; bx r0; nop
        let code: [u16; 8] = [0xE7FE, 0xBF00, 0x4802, 0x4903, 0x6001, 0x4803, 0x4700, 0xBF00];
        bytes.extend(code.iter().flat_map(|half| half.to_le_bytes()));
        bytes.extend([VTOR, AT, firmware].iter().flat_map(|word| word.to_le_bytes()));
        self.loader = Some(Loader { at: AT.into(), bytes });
        Ok(())
    }
}
