//! Minimal images that pass xtask's checks.

use crate::chips::{Chip, FLASH};

/// Bytes; on the f405 the code ends in the fifth sector.
const CODE: usize = 0x4800;
const CONSTANTS: usize = 0x130;
const VALUES: usize = 0x24;
/// Bytes of statics; address of retained data.
const STATICS: u32 = 0x400;
const RETAINED: u32 = 0x2001_FC00;
const GAP: u32 = 12;

pub struct Fixture {
    pub elf: Vec<u8>,
    /// Flash afterwards: address and bytes of each segment.
    pub segments: Vec<(usize, Vec<u8>)>,
}

struct Section {
    name: &'static str,
    kind: u32,
    flags: u32,
    address: u32,
    loaded: u32,
    bytes: Vec<u8>,
    length: u32,
}

const PROGBITS: u32 = 1;
const NOBITS: u32 = 8;
const ALLOC: u32 = 2;
const WRITE: u32 = 1;
const EXECUTE: u32 = 4;
const OBJECT: u8 = 1;
const FUNCTION: u8 = 2;

pub fn image(chip: &Chip) -> Fixture {
    let text = chip.text;
    let [reset, fault, default] = [text, text + 0x40, text + 0x42];
    let levels = [text + 0x44, text + 0x46];

    let mut vectors = vec![0u32; 16 + chip.interrupts];
    vectors
        .iter_mut()
        .skip(2)
        .for_each(|vector| *vector = default | 1);
    [vectors[0], vectors[1], vectors[3]] = [chip.stack, reset | 1, fault | 1];
    for ((_, number), handler) in chip.levels.iter().zip(levels) {
        vectors[16 + number] = handler | 1;
    }
    // ldr r0, =VTOR; ldr r1, =table; str r1, [r0]; b .; then the words.
    let mut code: Vec<u8> = (0..CODE).map(|at| (at * 13 + at / 255) as u8 & 0x7F).collect();
    let start: [u16; 4] = [0x4801, 0x4902, 0x6001, 0xE7FE];
    for (at, half) in start.iter().enumerate() {
        code[2 * at..2 * at + 2].copy_from_slice(&half.to_le_bytes());
    }
    for (at, word) in [0xE000_ED08, FLASH as u32].iter().enumerate() {
        code[8 + 4 * at..12 + 4 * at].copy_from_slice(&word.to_le_bytes());
    }
    let pattern = |count: usize, step: usize| -> Vec<u8> { (0..count).map(|at| (at * step) as u8).collect() };
    let constants = text + CODE as u32 + GAP;
    let values = constants + CONSTANTS as u32;
    let section = |name, flags, address, loaded, bytes: Vec<u8>| Section {
        name,
        kind: PROGBITS,
        flags: ALLOC | flags,
        address,
        loaded,
        length: bytes.len() as u32,
        bytes,
    };
    let table: Vec<u8> = vectors.iter().flat_map(|vector| vector.to_le_bytes()).collect();
    let mut sections = vec![
        section(".vector_table", 0, FLASH as u32, FLASH as u32, table),
        section(".text", EXECUTE, text, text, code),
        section(".rodata", 0, constants, constants, pattern(CONSTANTS, 3)),
        section(".data", WRITE, chip.ram, values, pattern(VALUES, 5)),
    ];
    let bss = chip.ram + 0x100;
    for (name, address, length) in [(".bss", bss, STATICS), (".retained", RETAINED, 0x184)] {
        sections.push(Section {
            name,
            kind: NOBITS,
            flags: ALLOC | WRITE,
            address,
            loaded: address,
            bytes: Vec::new(),
            length,
        });
    }
    let segments = sections.iter().filter(|s| s.kind == PROGBITS);
    let segments = segments.map(|s| (s.loaded as usize, s.bytes.clone())).collect();

    let mut symbols: Vec<(String, u32, u32, u8)> = [
        ("Reset", reset | 1, 8, FUNCTION),
        ("HardFault", fault | 1, 2, FUNCTION),
        ("DefaultHandler", default | 1, 2, FUNCTION),
        ("__vector_table", FLASH as u32, 0, OBJECT),
        ("_stack_start", chip.stack, 0, 0),
        ("_stack_end", chip.stack - 0x8000, 0, 0),
        ("__sdata", chip.ram, 0, 0),
        ("__edata", chip.ram + VALUES as u32, 0, 0),
        ("__sbss", bss, 0, 0),
        ("__ebss", bss + STATICS, 0, 0),
        ("_ZN6sophie5board7DMA_IMU17h0123456789abcdefE", bss, 32, OBJECT),
        (
            "_ZN6sophie5board6DMA_RC17h0123456789abcdefE",
            bss + 32,
            32,
            OBJECT,
        ),
        (
            "_ZN6sophie5board7DMA_ADC17h0123456789abcdefE",
            bss + 64,
            32,
            OBJECT,
        ),
        (
            "_ZN6sophie5tasks3imu4POOL17h0123456789abcdefE",
            bss + 96,
            64,
            OBJECT,
        ),
        (
            "_ZN6sophie5board5stm329flash_ecc11begin_guard17h0123456789abcdefE",
            fault | 1,
            2,
            FUNCTION,
        ),
    ]
    .map(|(name, address, size, kind)| (name.to_string(), address, size, kind))
    .into();
    for ((name, _), handler) in chip.levels.iter().zip(levels) {
        symbols.push((name.to_string(), handler | 1, 2, FUNCTION));
    }
    if let Some(params) = &chip.params {
        symbols.push(("_params_start".into(), params.start as u32, 0, 0));
        symbols.push(("_params_end".into(), params.end as u32, 0, 0));
    }
    Fixture {
        elf: elf(reset | 1, &sections, &symbols),
        segments,
    }
}

/// A 32-bit little-endian ELF for Arm.
fn elf(entry: u32, sections: &[Section], symbols: &[(String, u32, u32, u8)]) -> Vec<u8> {
    let mut file = vec![0; 52 + 32 * sections.len()];
    let mut headers = vec![[0u32; 10]];
    let mut programs = Vec::new();
    let mut names = vec![0u8];
    let mut named = |name: &str| {
        let at = names.len() as u32;
        names.extend(name.bytes().chain([0]));
        at
    };
    let add = |file: &mut Vec<u8>, bytes: &[u8]| {
        file.resize(file.len().next_multiple_of(4), 0);
        let at = file.len() as u32;
        file.extend(bytes);
        at
    };
    for s in sections {
        let at = add(&mut file, &s.bytes);
        headers.push([
            named(s.name),
            s.kind,
            s.flags,
            s.address,
            at,
            s.length,
            0,
            0,
            4,
            0,
        ]);
        programs.push([1, at, s.address, s.loaded, s.bytes.len() as u32, s.length, 4, 4]);
    }
    let (mut table, mut strings) = (vec![0u8; 16], vec![0u8]);
    for (name, address, size, kind) in symbols {
        let at = strings.len() as u32;
        strings.extend(name.bytes().chain([0]));
        table.extend([at, *address, *size].iter().flat_map(|word| word.to_le_bytes()));
        // In the section that holds it, or absolute.
        let holds = |s: &Section| (s.address..s.address + s.length).contains(address);
        let section = sections
            .iter()
            .position(holds)
            .map_or(0xFFF1, |nth| nth as u16 + 1);
        table.extend([1 << 4 | kind, 0]);
        table.extend(section.to_le_bytes());
    }
    let count = headers.len() as u32;
    let at = add(&mut file, &table);
    headers.push([
        named(".symtab"),
        2,
        0,
        0,
        at,
        table.len() as u32,
        count + 1,
        1,
        4,
        16,
    ]);
    let at = add(&mut file, &strings);
    headers.push([named(".strtab"), 3, 0, 0, at, strings.len() as u32, 0, 0, 1, 0]);
    let own = named(".shstrtab");
    let at = add(&mut file, &names);
    headers.push([own, 3, 0, 0, at, names.len() as u32, 0, 0, 1, 0]);
    let place = add(&mut file, &[]);
    file.extend(headers.iter().flatten().flat_map(|word| word.to_le_bytes()));

    let mut head = b"\x7FELF\x01\x01\x01\0\0\0\0\0\0\0\0\0".to_vec();
    // Executable, Arm, version 1.
    head.extend([2, 0, 40, 0, 1, 0, 0, 0]);
    head.extend(
        [entry, 52, place, 0x0500_0400]
            .iter()
            .flat_map(|word| word.to_le_bytes()),
    );
    let counts = [
        52,
        32,
        programs.len() as u16,
        40,
        count as u16 + 3,
        count as u16 + 2,
    ];
    head.extend(counts.iter().flat_map(|half| half.to_le_bytes()));
    head.extend(
        programs
            .iter()
            .flatten()
            .flat_map(|word: &u32| word.to_le_bytes()),
    );
    file[..head.len()].copy_from_slice(&head);
    file
}
