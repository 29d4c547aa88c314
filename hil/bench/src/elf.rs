//! The image that is flashed: the ELF with what the bench has to know of it.

use std::path::{Path, PathBuf};

use defmt_decoder::Table;
use object::{Architecture, Object, ObjectSection, ObjectSymbol};

/// Flash of the STM32H743: first address, and first one beyond.
const FLASH: (u64, u64) = (0x0800_0000, 0x0820_0000);
/// Name of the board in its image.
const BOARD: &str = "matek-h743";
/// RAM that the stack may lie in: DTCM, AXI SRAM.
const RAM: [(u64, u64); 2] = [(0x2000_0000, 0x2002_0000), (0x2400_0000, 0x2408_0000)];

/// A firmware image.
pub struct Firmware {
    /// Where it was read from.
    pub path: PathBuf,
    /// The file.
    pub bytes: Vec<u8>,
    /// Address of the log's control block.
    pub rtt: u64,
    /// How the log is written.
    pub table: Table,
}

impl Firmware {
    /// Reads an image for the STM32H743.
    ///
    /// # Errors
    /// One line: the file, what is wrong with it and what is wanted.
    pub fn read(path: &Path) -> Result<Self, String> {
        let bytes = std::fs::read(path).map_err(|e| format!("{}: cannot be read: {e}", path.display()))?;
        let wrong = |what: String| format!("{}: {what}", path.display());
        let wanted = "wanted is what `cargo xtask firmware matek-h743` builds";
        let file = object::File::parse(&*bytes).map_err(|_| wrong(format!("is no ELF file; {wanted}")))?;
        if file.architecture() != Architecture::Arm || file.is_64() {
            let found = file.architecture();
            return Err(wrong(format!(
                "is built for {found:?}, not for a 32-bit Arm; {wanted}"
            )));
        }
        let section = |name| file.section_by_name(name);
        let vectors =
            section(".vector_table").ok_or_else(|| wrong(format!("has no vector table; {wanted}")))?;
        if vectors.address() != FLASH.0 {
            let found = vectors.address();
            return Err(wrong(format!(
                "has its vector table at {found:#010x}, not at {:#010x}; {wanted}",
                FLASH.0
            )));
        }
        let stack = vectors
            .data()
            .ok()
            .and_then(|data| Some(u64::from(u32::from_le_bytes(data.get(..4)?.try_into().ok()?))))
            .unwrap_or(0);
        if !RAM.iter().any(|(first, end)| (first + 4..=*end).contains(&stack)) {
            return Err(wrong(format!(
                "starts its stack at {stack:#010x}, where an STM32H743 has no RAM; {wanted}"
            )));
        }
        // The name that the image greets with: boards of other chips also start at this flash address.
        let named = |name: &[u8]| {
            let mut data = file
                .sections()
                .filter(|s| s.address() != 0)
                .filter_map(|s| s.data().ok());
            data.any(|bytes| bytes.windows(name.len()).any(|window| window == name))
        };
        if !named(BOARD.as_bytes()) {
            return Err(wrong(format!("does not call itself {BOARD}; {wanted}")));
        }
        for section in file.sections() {
            let end = section.address() + section.size();
            if section.address() >= FLASH.0 && section.address() < FLASH.1 && end > FLASH.1 {
                let name = section.name().unwrap_or("?").to_owned();
                return Err(wrong(format!("has {name} beyond the end of the flash; {wanted}")));
            }
        }
        let rtt = file
            .symbols()
            .find(|s| s.name() == Ok("_SEGGER_RTT"))
            .map(|s| s.address())
            .ok_or_else(|| wrong(format!("has no log (symbol _SEGGER_RTT); {wanted}")))?;
        let table = Table::parse(&bytes)
            .map_err(|e| wrong(format!("has a log that cannot be decoded: {e}")))?
            .ok_or_else(|| wrong(format!("has no table of log messages (.defmt); {wanted}")))?;
        Ok(Self {
            path: path.to_owned(),
            rtt,
            table,
            bytes,
        })
    }
}
