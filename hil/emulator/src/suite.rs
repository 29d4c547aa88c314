//! The image of a board's tests (`hil/rig`). Instead of a probe that answers with a test's address, calls of setup and
//! test replace the start of the requesting function.

use std::collections::BTreeMap;

use object::{Object, ObjectSection, ObjectSymbol};
use serde::Deserialize;

use crate::elf::Firmware;

/// Function that requests the command line.
const ASKING: &str = "__embedded_test_start";
const SETUP: &str = "_embedded_test_setup";
/// Section of test descriptions: function address and module.
const TESTS: &str = ".embedded_test";
const VERSION: (&str, u8) = ("EMBEDDED_TEST_VERSION", 1);

/// A test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Test {
    /// Module and function.
    pub name: String,
    /// Passes only by a panic.
    pub should_panic: bool,
    /// Run only on request.
    pub ignored: bool,
    entry: u32,
}

#[derive(Deserialize)]
struct Described {
    name: String,
    should_panic: bool,
    ignored: bool,
}

/// The tests of `image`, by name.
///
/// # Errors
/// One line: it has no tests, or other descriptions.
pub fn tests(image: &Firmware) -> Result<Vec<Test>, String> {
    let file = parsed(&image.bytes)?;
    let section = file
        .section_by_name(TESTS)
        .ok_or("the image holds no tests: wanted is what `cargo xtask rig BOARD --build` builds")?;
    let data = section.data().map_err(|e| e.to_string())?;
    let described = |symbol: &object::Symbol<'_, '_>| symbol.section_index() == Some(section.index());
    let mut tests = BTreeMap::new();
    for symbol in file.symbols().filter(described) {
        let name = symbol.name().map_err(|e| e.to_string())?;
        let offset = (symbol.address() - section.address()) as usize;
        let word = |nth: usize| {
            let bytes = data.get(offset + 4 * nth..offset + 4 * nth + 4)?;
            Some(u32::from_le_bytes(bytes.try_into().ok()?))
        };
        if name == VERSION.0 {
            if word(0) != Some(VERSION.1.into()) {
                return Err(format!("the image describes its tests in version {:?}", word(0)));
            }
            continue;
        }
        let Ok(described) = serde_json::from_str::<Described>(name) else {
            continue;
        };
        let place = word(0).zip(word(1)).zip(word(2));
        let ((entry, module), length) = place.ok_or("a test's description is cut short")?;
        let module = bytes_at(&file, module.into(), length as usize).ok_or("a test without module")?;
        let module = String::from_utf8_lossy(module);
        // Drops the crate and the module inside every file.
        let (_, module) = module.split_once("::").unwrap_or(("", &module));
        let name = format!("{}::{}", module.trim_end_matches("::tests"), described.name);
        let test = Test {
            name: name.clone(),
            should_panic: described.should_panic,
            ignored: described.ignored,
            entry,
        };
        tests.insert(name, test);
    }
    Ok(tests.into_values().collect())
}

/// `image` changed to run only `test`.
///
/// # Errors
/// One line: the image lacks a function.
pub fn entering(image: &Firmware, test: &Test) -> Result<Vec<u8>, String> {
    let file = parsed(&image.bytes)?;
    let symbol = |name: &str| {
        file.symbols()
            .find(|s| s.name() == Ok(name))
            .ok_or_else(|| format!("the image has no function {name}"))
    };
    let asking = symbol(ASKING)?;
    let code = enter(
        asking.address() & !1,
        (symbol(SETUP)?.address() | 1) as u32,
        test.entry | 1,
    );
    if asking.size() < code.len() as u64 {
        return Err(format!(
            "{ASKING} has {} bytes, wanted are {}",
            asking.size(),
            code.len()
        ));
    }
    let place = file_offset(&file, asking.address() & !1).ok_or("the image has no code")?;
    let mut bytes = image.bytes.clone();
    bytes
        .get_mut(place..place + code.len())
        .ok_or("the image is cut short")?
        .copy_from_slice(&code);
    Ok(bytes)
}

/// Thumb code at `address`: calls `setup`, jumps to `test`.
fn enter(address: u64, setup: u32, test: u32) -> Vec<u8> {
    const NOP: u16 = 0xBF00;
    // ldr r0, [pc, #4]; blx r0; ldr r0, [pc, #4]; bx r0: the literals follow, if aligned.
    const CALLS: [u16; 4] = [0x4801, 0x4780, 0x4801, 0x4700];
    let aligned = address.is_multiple_of(4);
    let lead = if aligned { None } else { Some(NOP) };
    let code = lead.into_iter().chain(CALLS).flat_map(u16::to_le_bytes);
    code.chain([setup, test].into_iter().flat_map(u32::to_le_bytes))
        .collect()
}

fn parsed(bytes: &[u8]) -> Result<object::File<'_>, String> {
    object::File::parse(bytes).map_err(|e| e.to_string())
}

fn section_at<'a, 'b>(file: &'b object::File<'a>, address: u64) -> Option<(object::Section<'a, 'b>, usize)> {
    file.sections()
        .filter(|s| s.address() != 0)
        .find(|s| (s.address()..s.address() + s.size()).contains(&address))
        .map(|s| {
            let offset = (address - s.address()) as usize;
            (s, offset)
        })
}

fn bytes_at<'a>(file: &object::File<'a>, address: u64, length: usize) -> Option<&'a [u8]> {
    let (section, offset) = section_at(file, address)?;
    section.data().ok()?.get(offset..offset + length)
}

fn file_offset(file: &object::File<'_>, address: u64) -> Option<usize> {
    let (section, offset) = section_at(file, address)?;
    Some(section.file_range()?.0 as usize + offset)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Literal fetched by a load at `at` (ARMv7-M, A7.7.44).
    fn loaded(code: &[u8], address: u64, at: usize) -> u32 {
        let half = u16::from_le_bytes([code[at], code[at + 1]]);
        assert_eq!(half >> 8, 0x48);
        let place = ((address as usize + at + 4) & !3) + usize::from(half & 0xFF) * 4 - address as usize;
        u32::from_le_bytes(code[place..place + 4].try_into().unwrap())
    }

    #[test]
    fn the_setup_is_called_and_then_the_test_wherever_the_code_lies() {
        for (address, lead) in [(0x0800_1000, 0), (0x0800_1002, 2)] {
            let code = enter(address, 0x111, 0x222);
            assert_eq!(loaded(&code, address, lead), 0x111);
            assert_eq!(loaded(&code, address, lead + 4), 0x222);
            assert_eq!(code.len(), lead + 16);
        }
    }
}
