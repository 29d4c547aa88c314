//! ELF contents for the checks.

use std::collections::{BTreeMap, HashMap};
use std::path::Path;

use object::read::elf::{ElfFile32, ProgramHeader};
use object::{Object, ObjectSection, ObjectSymbol, SectionFlags, SymbolKind};

use crate::Error;

pub struct Section {
    pub name: String,
    /// Run-time address.
    pub address: u64,
    pub size: u64,
    /// It has contents; otherwise it is RAM that start-up clears or keeps.
    pub in_image: bool,
    pub writable: bool,
}

pub struct Load {
    /// Load address.
    pub address: u64,
    pub bytes: Vec<u8>,
}

impl Load {
    pub fn size(&self) -> u64 {
        self.bytes.len() as u64
    }
}

pub struct Static {
    pub name: String,
    pub address: u64,
    pub size: u64,
}

#[derive(Default)]
pub struct Image {
    /// Address of the first instruction.
    pub entry: u64,
    pub sections: Vec<Section>,
    pub loads: Vec<Load>,
    pub statics: Vec<Static>,
    pub functions: Vec<Static>,
    /// Addresses of all named symbols.
    pub symbols: HashMap<String, u64>,
    /// Where code (true) or constants between it (false) begin, as the assembler marks them.
    pub code: BTreeMap<u64, bool>,
    /// Words of the vector table.
    pub vectors: Vec<u32>,
}

#[derive(Default)]
struct Symbols {
    statics: Vec<Static>,
    functions: Vec<Static>,
    code: BTreeMap<u64, bool>,
    addresses: HashMap<String, u64>,
}

impl Symbols {
    fn of(file: &ElfFile32<'_, object::Endianness>, sections: &[Section]) -> Self {
        let mut symbols = Self::default();
        for symbol in file.symbols() {
            let Ok(name) = symbol.name() else { continue };
            // Log texts are symbols too, in sections that are not loaded.
            let on_chip = |s: &Section| (s.address..s.address + s.size).contains(&symbol.address());
            if symbol.kind() == SymbolKind::Data && sections.iter().any(on_chip) {
                symbols.statics.push(Static {
                    name: name.into(),
                    address: symbol.address(),
                    size: symbol.size(),
                });
            }
            if symbol.kind() == SymbolKind::Text {
                symbols.functions.push(Static {
                    name: name.into(),
                    address: symbol.address() & !1,
                    size: symbol.size(),
                });
            }
            // Mapping symbols of the Arm ELF: `$t`, `$d`, and either with a suffix.
            if let Some(of_code) = match name.get(..2) {
                Some("$t") => Some(true),
                Some("$d") => Some(false),
                _ => None,
            } && sections.iter().any(on_chip)
            {
                symbols.code.insert(symbol.address(), of_code);
            }
            symbols.addresses.insert(name.to_string(), symbol.address());
        }
        symbols
    }
}

impl Image {
    /// The image's bytes at a run-time address that is their load address too; fewer where it has none.
    pub fn bytes(&self, address: u64, length: u64) -> &[u8] {
        let load = self
            .loads
            .iter()
            .find(|load| (load.address..load.address + load.bytes.len() as u64).contains(&address));
        let bytes = load.and_then(|load| load.bytes.get((address - load.address) as usize..));
        let bytes = bytes.unwrap_or_default();
        bytes.get(..length as usize).unwrap_or(bytes)
    }

    /// Reads the ELF at `path`.
    ///
    /// # Errors
    /// Not an ELF, or one without vector table.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(path)?;
        let file = ElfFile32::<object::Endianness>::parse(&*bytes)?;
        let endian = file.endian();
        let table = file
            .section_by_name(".vector_table")
            .ok_or("the image has no vector table")?;
        let words = table.data()?.as_chunks().0;
        let mut sections = Vec::new();
        for section in file.sections() {
            let SectionFlags::Elf { sh_flags } = section.flags() else {
                continue;
            };
            if sh_flags & u64::from(object::elf::SHF_ALLOC) == 0 || section.size() == 0 {
                continue;
            }
            sections.push(Section {
                name: section.name()?.to_string(),
                address: section.address(),
                size: section.size(),
                in_image: section.kind() != object::SectionKind::UninitializedData,
                writable: sh_flags & u64::from(object::elf::SHF_WRITE) != 0,
            });
        }
        let mut loads = Vec::new();
        for header in file.elf_program_headers() {
            if header.p_type(endian) == object::elf::PT_LOAD && header.p_filesz(endian) > 0 {
                let bytes = header
                    .data(endian, &*bytes)
                    .map_err(|()| "the image is cut short")?;
                loads.push(Load {
                    address: header.p_paddr(endian).into(),
                    bytes: bytes.to_vec(),
                });
            }
        }
        let Symbols {
            statics,
            functions,
            code,
            addresses,
        } = Symbols::of(&file, &sections);
        Ok(Self {
            entry: file.entry(),
            sections,
            loads,
            statics,
            functions,
            symbols: addresses,
            code,
            vectors: words.iter().map(|word| u32::from_le_bytes(*word)).collect(),
        })
    }

    /// The word that flashing writes to `address`.
    pub fn word(&self, address: u64) -> Option<u32> {
        self.loads.iter().find_map(|load| {
            let offset = usize::try_from(address.checked_sub(load.address)?).ok()?;
            let bytes = load.bytes.get(offset..offset + 4)?;
            Some(u32::from_le_bytes(bytes.try_into().ok()?))
        })
    }

    /// The halfword that flashing writes to `address`; erased flash outside the image.
    pub fn halfword(&self, address: u64) -> u16 {
        let word = self.word(address & !3).unwrap_or(u32::MAX);
        (if address & 2 == 0 { word } else { word >> 16 }) as u16
    }

    /// Whether code is at `address`, and no constants.
    pub fn is_code(&self, address: u64) -> bool {
        self.code
            .range(..=address)
            .next_back()
            .is_none_or(|(_, code)| *code)
    }

    /// Build identifier of the image, as the firmware reports it.
    ///
    /// # Errors
    /// The symbol is missing.
    pub fn build(&self) -> Result<u32, Error> {
        let values = self.symbol("__edata")? - self.symbol("__sdata")?;
        let (start, end) = (self.symbol("__stext")?, self.symbol("__sidata")? + values);
        // Erased flash.
        let word = |at| self.word(at).unwrap_or(u32::MAX);
        Ok(sophie_image_id::of((start..end).step_by(4).map(word)))
    }

    /// Address of the symbol `name`.
    ///
    /// # Errors
    /// The image does not define it.
    pub fn symbol(&self, name: &str) -> Result<u64, Error> {
        self.symbols
            .get(name)
            .copied()
            .ok_or_else(|| format!("the image has no symbol `{name}`").into())
    }
}
