//! Writes firmware through the chip's USB loader (ST's AN2606 and AN3156).
//!
//! `dfu-util` erases each sector that a file touches, without memory of earlier calls. So the image is written in
//! stretches that share no sector: a flat file would erase the gaps (on the f405 the stored parameters), a file per
//! segment the end of the previous one. The vector table's stretch comes last: the loader starts the firmware at
//! the address of the last call, and an interrupted transfer leaves the old table or none.

use std::fs;
use std::path::PathBuf;

use crate::boards::{Board, FLASH, Sectors, UsbLoader};
use crate::image::{Image, Load};
use crate::tools::DFU_UTIL;
use crate::{Error, build};

/// ST's loader, all chips.
const DEVICE: &str = "0483:df11";
/// Flash; other settings are option bytes and one-time memory.
const SETTING: &str = "0";
/// Largest flash word, bytes (H7): stretches are whole words.
const WORD: u64 = 32;

/// Bytes to write in one call.
#[derive(Debug, PartialEq, Eq)]
pub struct Stretch {
    pub start: u64,
    pub bytes: Vec<u8>,
}

/// Writes `image` to the chip in its loader and starts it; `dry` only prints the commands.
///
/// # Errors
/// No such chip is in its loader, or dfu-util fails.
pub fn flash(board: &Board, image: &Image, dry: bool) -> Result<(), Error> {
    let (UsbLoader::Enter(enter) | UsbLoader::ByFirmware(enter)) = board.usb_loader;
    let stretches = stretches(&image.loads, board.flash)?;
    let files = files(board, &stretches)?;
    if !dry {
        chip(board, enter)?;
    }
    let last = stretches.len();
    for (nth, (stretch, file)) in (1..).zip(stretches.iter().zip(&files)) {
        let address = format!(
            "{:#010x}{}",
            stretch.start,
            if nth == last { ":leave" } else { "" }
        );
        let mut command = DFU_UTIL.command(&["-d", DEVICE, "-a", SETTING, "-s", &address, "-D"]);
        command.arg(file);
        if dry {
            println!("{}", build::shown(&command));
            continue;
        }
        DFU_UTIL.run(&mut command).map_err(|e| {
            format!(
                "{e} at {:#010x}, part {nth} of {last}: the board has no whole firmware now; {enter} again, and repeat",
                stretch.start
            )
        })?;
    }
    if !dry {
        eprintln!("written and started");
    }
    Ok(())
}

/// Stretches of `loads` in writing order, the vector table's last.
///
/// # Errors
/// A part lies outside the flash, or overlaps another.
fn stretches(loads: &[Load], flash: &[Sectors]) -> Result<Vec<Stretch>, Error> {
    let mut sorted: Vec<_> = loads.iter().collect();
    sorted.sort_by_key(|load| load.address);
    let mut stretches: Vec<Stretch> = Vec::new();
    for load in sorted {
        let outside = || {
            format!(
                "{} bytes at {:#010x} lie outside the flash",
                load.size(),
                load.address
            )
        };
        let first = sector(flash, load.address).ok_or_else(outside)?;
        sector(flash, load.address + load.size() - 1).ok_or_else(outside)?;
        let start = load.address / WORD * WORD;
        match stretches.last_mut() {
            Some(before) if before.end() > load.address => {
                return Err(format!("two parts of the image lie at {:#010x}", load.address).into());
            }
            // The sector in which the previous one ends must not be erased again.
            Some(before) if before.end() > first.0 => before.extend_to(load.address),
            _ => {
                let mut stretch = Stretch {
                    start,
                    bytes: Vec::new(),
                };
                stretch.extend_to(load.address);
                stretches.push(stretch);
            }
        }
        if let Some(stretch) = stretches.last_mut() {
            stretch.bytes.extend(&load.bytes);
        }
    }
    for stretch in &mut stretches {
        stretch.extend_to(stretch.end().next_multiple_of(WORD));
    }
    if stretches.first().is_none_or(|stretch| stretch.start != FLASH) {
        return Err(format!("the image has no vector table at {FLASH:#010x}, where its chip starts").into());
    }
    stretches.rotate_left(1);
    Ok(stretches)
}

impl Stretch {
    fn end(&self) -> u64 {
        self.start + self.bytes.len() as u64
    }

    /// Pads with erased bytes.
    fn extend_to(&mut self, address: u64) {
        let length = address.saturating_sub(self.start) as usize;
        self.bytes.resize(length.max(self.bytes.len()), 0xFF);
    }
}

/// First address and end of the sector of `address`.
pub fn sector(flash: &[Sectors], address: u64) -> Option<(u64, u64)> {
    let mut start = FLASH;
    for sectors in flash {
        let end = start + sectors.count * sectors.size;
        if (start..end).contains(&address) {
            let first = start + (address - start) / sectors.size * sectors.size;
            return Some((first, first + sectors.size));
        }
        start = end;
    }
    None
}

/// The files stay: the commands can be repeated by hand.
fn files(board: &Board, stretches: &[Stretch]) -> Result<Vec<PathBuf>, Error> {
    let folder = build::target_dir().join("dfu");
    fs::create_dir_all(&folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    stretches
        .iter()
        .map(|stretch| {
            let path = folder.join(format!("{}-{:#010x}.bin", board.name, stretch.start));
            fs::write(&path, &stretch.bytes).map_err(|e| format!("{}: {e}", path.display()))?;
            Ok(path)
        })
        .collect()
}

/// Checks that exactly one chip is in its loader, with the board's flash.
fn chip(board: &Board, enter: &str) -> Result<(), Error> {
    let output = DFU_UTIL.ask(&mut DFU_UTIL.command(&["-d", DEVICE, "--list"]))?;
    let [listed, complaints] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    match &found(&listed)[..] {
        [] if complaints.contains("Cannot open DFU device") => Err(
            "dfu-util may not open the chip: run it as root or give users access by a udev rule for USB device 0483:df11"
                .into(),
        ),
        [] => Err(format!(
            "dfu-util finds no chip in its USB loader: {enter}; `dfu-util --list` then shows {DEVICE}"
        )
        .into()),
        [layout] if flash_of(layout).is_some_and(|found| same(&found, board.flash)) => Ok(()),
        [layout] => Err(format!(
            "the chip in its USB loader has the flash `{layout}`, a {} has {}: is it another board?",
            board.name,
            shown(board.flash)
        )
        .into()),
        several => Err(format!("{} chips are in their USB loader: leave one plugged in", several.len()).into()),
    }
}

/// Layouts listed by `dfu-util --list`.
fn found(listed: &str) -> Vec<String> {
    let field = |line: &str, name: &str| {
        let (_, rest) = line.split_once(&format!("{name}="))?;
        Some(rest.trim_start_matches('"').split('"').next()?.to_string())
    };
    listed
        .lines()
        .filter(|line| line.starts_with("Found DFU:") && line.contains(&format!("alt={SETTING},")))
        .filter_map(|line| field(line, "name"))
        .collect()
}

/// Parses `@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg` (UM0424, §4.3.2).
fn flash_of(layout: &str) -> Option<Vec<Sectors>> {
    let mut parts = layout.split('/').skip(1);
    let start = parts.next()?.trim().strip_prefix("0x")?;
    if u64::from_str_radix(start, 16).ok()? != FLASH {
        return None;
    }
    let sectors = parts.next()?.split(',').map(|equal| {
        let (count, size) = equal.trim().split_once('*')?;
        let digits = size.bytes().take_while(u8::is_ascii_digit).count();
        let (size, unit) = size.split_at(digits);
        let unit = match unit.bytes().next()? {
            b'K' => 1024,
            b'M' => 1024 * 1024,
            _ => 1,
        };
        Some(Sectors {
            count: count.parse().ok()?,
            size: size.parse::<u64>().ok()? * unit,
        })
    });
    sectors.collect()
}

/// Equal sectors, whatever the grouping.
fn same(one: &[Sectors], other: &[Sectors]) -> bool {
    let each = |flash: &[Sectors]| -> Vec<u64> {
        let sizes = flash
            .iter()
            .flat_map(|equal| (0..equal.count).map(|_| equal.size));
        sizes.collect()
    };
    each(one) == each(other)
}

fn shown(flash: &[Sectors]) -> String {
    let equal = flash
        .iter()
        .map(|equal| format!("{} x {} KiB", equal.count, equal.size / 1024));
    equal.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    const F405: &[Sectors] = &[
        Sectors {
            count: 4,
            size: 16 * 1024,
        },
        Sectors {
            count: 1,
            size: 64 * 1024,
        },
        Sectors {
            count: 7,
            size: 128 * 1024,
        },
    ];

    fn load(address: u64, bytes: &[u8]) -> Load {
        Load {
            address,
            bytes: bytes.to_vec(),
        }
    }

    #[test]
    fn a_sector_is_found_by_any_of_its_addresses() {
        for (address, found) in [
            (0x0800_0000, Some((0x0800_0000, 0x0800_4000))),
            (0x0800_BFFF, Some((0x0800_8000, 0x0800_C000))),
            (0x0801_0000, Some((0x0801_0000, 0x0802_0000))),
            (0x0803_FFFF, Some((0x0802_0000, 0x0804_0000))),
            (0x080F_FFFF, Some((0x080E_0000, 0x0810_0000))),
            (0x0810_0000, None),
            (0x07FF_FFFF, None),
        ] {
            assert_eq!(sector(F405, address), found, "{address:#x}");
        }
    }

    #[test]
    fn what_shares_a_sector_is_written_at_one_go_and_the_vector_table_last() {
        // Table; code and constants in one sector with a gap; initial values two sectors on.
        let loads = [
            load(0x0800_0000, &[1; 40]),
            load(0x0800_C000, &[2; 64]),
            load(0x0800_C048, &[3; 8]),
            load(0x0802_0004, &[4; 4]),
        ];
        let written = stretches(&loads, F405).unwrap();
        let code = [vec![2; 64], vec![0xFF; 8], vec![3; 8], vec![0xFF; 16]].concat();
        let values = [vec![0xFF; 4], vec![4; 4], vec![0xFF; 24]].concat();
        let table = [vec![1; 40], vec![0xFF; 24]].concat();
        let expected = [(0x0800_C000, code), (0x0802_0000, values), (0x0800_0000, table)];
        let written: Vec<_> = written.into_iter().map(|s| (s.start, s.bytes)).collect();
        assert_eq!(written, expected);
    }

    #[test]
    fn an_image_that_the_chip_cannot_hold_or_start_is_refused() {
        for loads in [
            &[load(0x0800_C000, &[1])] as &[Load],
            &[load(0x0800_0000, &[1; 8]), load(0x0800_0004, &[2; 8])],
            &[load(0x0800_0000, &[1; 8]), load(0x080F_FFFC, &[2; 8])],
            &[load(0x0800_0000, &[1; 8]), load(0x2000_0000, &[2; 8])],
            &[],
        ] {
            let complaint = stretches(loads, F405).unwrap_err().to_string();
            assert!(!complaint.contains('\n'), "{complaint}");
        }
    }

    #[test]
    fn a_chip_is_known_by_its_flash() {
        for (layout, known) in [
            ("@Internal Flash  /0x08000000/04*016Kg,01*064Kg,07*128Kg", true),
            ("@Internal Flash  /0x08000000/4*16Kg,1*64Kg,3*128Kg,4*128Kg", true),
            ("@Internal Flash  /0x08000000/04*016Kg,01*064Kg,03*128Kg", false),
            ("@Internal Flash   /0x08000000/16*128Kg", false),
            ("@Option Bytes  /0x1FFFC000/01*016 e", false),
            ("UNKNOWN", false),
        ] {
            let found = flash_of(layout);
            assert_eq!(found.is_some_and(|f| same(&f, F405)), known, "{layout}");
        }
    }
}
