//! Stand-ins for dfu-util 0.11 and probe-rs 0.32 on a flash in a file.

use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use crate::chips::{self, Chip, FLASH};

/// Variable with the stand-ins' folder.
pub const FOLDER: &str = "STAND_INS";
/// Files: flash, calls, board, error mode, start address.
pub const MEMORY: &str = "flash.bin";
pub const CALLS: &str = "calls";
pub const BOARD: &str = "board";
pub const MOOD: &str = "mood";
pub const STARTED: &str = "started";

/// dfu-util's exit status for wrong arguments and failed devices (sysexits.h).
const USAGE: u8 = 64;
const DEVICE: u8 = 74;

fn folder() -> PathBuf {
    std::env::var_os(FOLDER).unwrap().into()
}

fn text(name: &str) -> String {
    fs::read_to_string(folder().join(name)).unwrap_or_default()
}

fn chip() -> &'static Chip {
    chips::find(text(BOARD).trim())
}

/// Records the call; returns its words, and the number of calls with the first one.
fn called(program: &str) -> (Vec<String>, usize) {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let line = format!("{program} {}\n", words.join(" "));
    let mut calls = fs::OpenOptions::new();
    let mut calls = calls
        .append(true)
        .create(true)
        .open(folder().join(CALLS))
        .unwrap();
    calls.write_all(line.as_bytes()).unwrap();
    let begins = format!("{program} {}", words.first().map_or("", |word| word));
    let count = text(CALLS)
        .lines()
        .filter(|call| call.starts_with(&begins))
        .count();
    (words, count)
}

/// Erases the sectors of `bytes` and writes; unerased bits stay 0.
fn program(address: usize, bytes: &[u8]) {
    let path = folder().join(MEMORY);
    let mut flash = fs::read(&path).unwrap();
    flash[chip().touched(address..address + bytes.len())].fill(0xFF);
    for (cell, byte) in flash[address - FLASH..].iter_mut().zip(bytes) {
        *cell &= byte;
    }
    fs::write(path, flash).unwrap();
}

fn number(text: &str) -> Option<usize> {
    match text.strip_prefix("0x") {
        Some(digits) => usize::from_str_radix(digits, 16).ok(),
        None => text.parse().ok(),
    }
}

pub fn dfu_util() -> ExitCode {
    let (words, _) = called("dfu-util");
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let mood = text(MOOD);
    println!("dfu-util 0.11\n\nCopyright 2005-2009 Weston Schmidt, Harald Welte and OpenMoko Inc.\n");
    match words[..] {
        ["-d", "0483:df11", "--list"] => list(&mood),
        ["-d", "0483:df11", "-a", "0", "-s", at, "-D", file] => download(&mood, at, file),
        _ => ExitCode::from(USAGE),
    }
}

fn list(mood: &str) -> ExitCode {
    let layout = match mood {
        "other chip" => "@Internal Flash  /0x08000000/04*016Kg,01*064Kg,03*128Kg",
        _ => chip().layout,
    };
    let found = |number: u8| {
        for (setting, name) in [(1, "@Option Bytes  /0x1FFFC000/01*016 e"), (0, layout)] {
            println!(
                "Found DFU: [0483:df11] ver=2200, devnum={number}, cfg=1, intf=0, path=\"1-{number}\", alt={setting}, \
                 name=\"{name}\", serial=\"3377337E353{number}\""
            );
        }
    };
    match mood {
        "no device" => {}
        "no right" => {
            eprintln!("dfu-util: Cannot open DFU device 0483:df11 found on devnum 9 (LIBUSB_ERROR_ACCESS)")
        }
        "two chips" => (1..3).for_each(found),
        _ => found(1),
    }
    ExitCode::SUCCESS
}

fn download(mood: &str, at: &str, file: &str) -> ExitCode {
    let (address, leave) = match at.split_once(':') {
        Some((address, "leave")) => (address, true),
        Some(_) => return ExitCode::from(USAGE),
        None => (at, false),
    };
    let (Some(address), Ok(bytes)) = (number(address), fs::read(file)) else {
        return ExitCode::from(USAGE);
    };
    let downloads = text(CALLS).lines().filter(|call| call.contains(" -D ")).count();
    if mood == format!("download {downloads} fails") {
        program(address, &bytes[..bytes.len() / 2]);
        eprintln!("dfu-util: Error during download get_status (LIBUSB_ERROR_NO_DEVICE)");
        return ExitCode::from(DEVICE);
    }
    program(address, &bytes);
    if leave {
        fs::write(folder().join(STARTED), format!("{address:#010x}")).unwrap();
    }
    ExitCode::SUCCESS
}

pub fn probe_rs() -> ExitCode {
    let (words, count) = called("probe-rs");
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let mood = text(MOOD);
    let own = |chip_name: &str| chip_name == chip().name;
    match words[..] {
        ["list"] if mood == "no probe" => println!("No debug probes were found."),
        ["list"] => {
            println!("The following debug probes were found:\n[0]: STLink V3 -- 0483:374e:0030 (ST-LINK)");
        }
        [
            "read",
            "--chip",
            name,
            "--format",
            "binary",
            "--output",
            file,
            "b32",
            at,
            count_of,
        ] if own(name) => {
            let (Some(at), Some(length)) = (number(at), number(count_of)) else {
                return ExitCode::from(2);
            };
            return read(&mood, count, file, at, 4 * length);
        }
        [
            "download",
            "--chip",
            name,
            "--binary-format",
            "bin",
            "--base-address",
            at,
            "--verify",
            file,
        ] if own(name) => {
            let bytes = fs::read(file).unwrap();
            let fails = mood == "download fails";
            let length = if fails { bytes.len() / 2 } else { bytes.len() };
            program(number(at).unwrap(), &bytes[..length]);
            if fails {
                eprintln!("Error: The flashing procedure failed");
                return ExitCode::FAILURE;
            }
        }
        ["reset", "--chip", name] if own(name) => {
            fs::write(folder().join(STARTED), "reset").unwrap();
        }
        ["run", "--chip", name, "--rtt-channel-mode", "no-block-trim", elf] if own(name) => {
            if mood == "run fails" {
                return ExitCode::FAILURE;
            }
            for (address, bytes) in joined(crate::fixture::image(chip()).segments) {
                program(address, &bytes);
            }
            assert!(fs::metadata(elf).is_ok());
        }
        _ => {
            eprintln!("error: unexpected argument found\n\nUsage: probe-rs <COMMAND>");
            return ExitCode::from(2);
        }
    }
    ExitCode::SUCCESS
}

/// Segments that share a sector: probe-rs erases once.
fn joined(segments: Vec<(usize, Vec<u8>)>) -> Vec<(usize, Vec<u8>)> {
    let mut joined: Vec<(usize, Vec<u8>)> = Vec::new();
    for (address, bytes) in segments {
        match joined.last_mut() {
            Some((start, before)) if chip().touched(*start..*start + before.len()).end + FLASH > address => {
                before.resize(address - *start, 0xFF);
                before.extend(bytes);
            }
            _ => joined.push((address, bytes)),
        }
    }
    joined
}

fn read(mood: &str, count: usize, file: &str, address: usize, length: usize) -> ExitCode {
    let flash = fs::read(folder().join(MEMORY)).unwrap();
    let mut bytes = flash[address - FLASH..address - FLASH + length].to_vec();
    if mood == "reads differ" && count == 2 {
        bytes[length - 3] ^= 1;
    }
    let half = mood == "short read" || mood == format!("read {count} fails") || mood == "read hangs";
    if half {
        bytes.truncate(length / 2);
    }
    fs::write(file, bytes).unwrap();
    if mood == "read hangs" {
        for _ in 0..200 {
            if text(MOOD) != mood {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
        return ExitCode::FAILURE;
    }
    if half && mood != "short read" {
        eprintln!("Error: Probe could not be opened");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
