//! The flashed image: the ELF with the addresses, tables and symbols that a run needs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use defmt_decoder::Table;
use object::{Architecture, Object, ObjectSection, ObjectSymbol};

use crate::board_kind::EmulatedBoard;
use crate::chain::Window;

/// Bytes of the largest image, with its debug information.
const MAX_BYTES: u64 = 256 * sophie_input::MIB;

/// Flash contents besides the firmware.
#[derive(Clone, Debug)]
pub struct Loader {
    /// Address.
    pub at: u64,
    /// Contents.
    pub bytes: Vec<u8>,
}

/// A firmware image.
pub struct Firmware {
    /// File.
    pub path: PathBuf,
    /// Contents of the file.
    pub bytes: Vec<u8>,
    /// Address of the control block.
    pub rtt: u64,
    /// First address and end.
    pub params: (u64, u64),
    /// Addresses, by names in `src/flight` and `src/firmware`.
    pub tasks: BTreeMap<String, u64>,
    /// Format of the log.
    pub table: Table,
    /// Target board.
    pub board: &'static EmulatedBoard,
    /// Runs before it.
    pub loader: Option<Loader>,
    /// Steps with counted instructions.
    pub count: Option<Window>,
}

impl Firmware {
    /// Reads an image for `board`.
    ///
    /// # Errors
    /// One line: the file, the fault, the requirement.
    pub fn read(path: &Path, board: &'static EmulatedBoard) -> Result<Self, String> {
        let bytes = sophie_input::read(path, MAX_BYTES)
            .map_err(|why| format!("{}: cannot be read: {why}", path.display()))?;
        let wrong = |what: String| format!("{}: {what}", path.display());
        let wanted = format!("wanted is what `cargo xtask firmware {}` builds", board.name);
        let file = object::File::parse(&*bytes).map_err(|_| wrong(format!("is no ELF file; {wanted}")))?;
        check(&file, board).map_err(|what| wrong(format!("{what}; {wanted}")))?;
        let symbol = |name: &str| {
            let mut symbols = file.symbols();
            symbols.find(|s| s.name() == Ok(name)).map(|s| s.address())
        };
        let rtt = symbol("_SEGGER_RTT")
            .ok_or_else(|| wrong(format!("has no log (symbol _SEGGER_RTT); {wanted}")))?;
        let params = symbol("_params_start")
            .zip(symbol("_params_end"))
            .filter(|(start, end)| board.flash.0 <= *start && start < end && *end <= board.flash.1)
            .ok_or_else(|| {
                wrong(format!(
                    "keeps no flash for parameters (symbols _params_start, _params_end); {wanted}"
                ))
            })?;
        let tasks = file
            .symbols()
            .filter_map(|s| Some((task(s.name().ok()?)?, s.address())))
            .collect();
        let table = Table::parse(&bytes)
            .map_err(|e| wrong(format!("has a log that cannot be decoded: {e}")))?
            .ok_or_else(|| wrong(format!("has no table of log messages (.defmt); {wanted}")))?;
        Ok(Self {
            path: path.to_owned(),
            rtt,
            params,
            tasks,
            table,
            bytes,
            board,
            loader: None,
            count: None,
        })
    }
}

fn check(file: &object::File<'_>, board: &EmulatedBoard) -> Result<(), String> {
    if file.architecture() != Architecture::Arm || file.is_64() {
        let found = file.architecture();
        return Err(format!("is built for {found:?}, not for a 32-bit Arm"));
    }
    let vectors = file
        .section_by_name(".vector_table")
        .ok_or("has no vector table")?;
    if vectors.address() != board.flash.0 {
        let found = vectors.address();
        return Err(format!(
            "has its vector table at {found:#010x}, not at {:#010x}",
            board.flash.0
        ));
    }
    let stack = vectors
        .data()
        .ok()
        .and_then(|data| Some(u64::from(u32::from_le_bytes(data.get(..4)?.try_into().ok()?))))
        .unwrap_or(0);
    if !board
        .ram
        .iter()
        .any(|(first, end)| (first + 4..=*end).contains(&stack))
    {
        return Err(format!(
            "starts its stack at {stack:#010x}, where an {} has no RAM",
            board.chip
        ));
    }
    // By the name in the first log line, as other boards' images share the address.
    let named = |name: &[u8]| {
        let mut data = file
            .sections()
            .filter(|s| s.address() != 0)
            .filter_map(|s| s.data().ok());
        data.any(|bytes| bytes.windows(name.len()).any(|window| window == name))
    };
    if !named(board.name.as_bytes()) {
        return Err(format!("does not call itself {}", board.name));
    }
    for section in file.sections() {
        let end = section.address() + section.size();
        if section.address() >= board.flash.0 && section.address() < board.flash.1 && end > board.flash.1 {
            let name = section.name().unwrap_or("?").to_owned();
            return Err(format!("has {name} beyond the end of the flash"));
        }
    }
    Ok(())
}

/// Task of the pool `symbol`: mangled names have each part's length before it.
fn task(symbol: &str) -> Option<String> {
    let (_, rest) = symbol.strip_suffix("4POOL")?.rsplit_once("5tasks")?;
    let name = rest.trim_start_matches(|c: char| c.is_ascii_digit());
    (rest.len() - name.len() > 0).then(|| name.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_task_is_found_by_its_pool() {
        let pool = "_RNvNvNtCs1qUga5DPFW4_13sophie_flight5tasks9commander4POOL";
        assert_eq!(task(pool).as_deref(), Some("commander"));
        assert_eq!(task("_RNvNvCs1qUga5DPFW4_6sophie14___embassy_main4POOL"), None);
    }
}
