//! `cargo xtask flash`: through the chip's loader, and by a probe.

use std::fs;
use std::ops::Range;

use libtest_mimic::Trial;

use crate::bench::{Bench, trial};
use crate::chips::{CUAV, Chip, F405, FLASH, MATEK};

pub fn tests() -> Vec<Trial> {
    vec![
        trial("f405_over_usb", f405_over_usb),
        trial("matek_over_usb", matek_over_usb),
        trial("by_probe", by_probe),
        trial("dry_calls_nothing", dry_calls_nothing),
        trial("what_is_missing_is_named", what_is_missing_is_named),
        trial("a_chip_that_is_not_there_or_another_is_left_alone", wrong_chip),
        trial("a_transfer_that_breaks_off_is_told", breaks_off),
        trial("cuav_over_usb", cuav_over_usb),
        trial("an_image_that_is_none_is_refused", no_image),
    ]
}

/// The f405's first, fourth and fifth sector, the Matek's first.
const F405_ERASED: &[Range<usize>] = &[0x0800_0000..0x0800_4000, 0x0800_C000..0x0802_0000];
#[allow(clippy::single_range_in_vec_init, reason = "one range, not its addresses")]
const MATEK_ERASED: &[Range<usize>] = &[0x0800_0000..0x0802_0000];

/// Requires the image in flash, unchanged outside `erased` (addresses).
fn flashed(bench: &Bench, erased: &[Range<usize>]) {
    let (flash, used) = (bench.memory(), bench.chip.used());
    for (address, bytes) in &bench.image.segments {
        let place = address - FLASH..address - FLASH + bytes.len();
        assert!(flash[place] == bytes[..], "segment at {address:#x}");
    }
    let touched = |at: usize| erased.iter().any(|range| range.contains(&(at + FLASH)));
    let changed = (0..flash.len()).find(|at| flash[*at] != used[*at] && !touched(*at));
    assert_eq!(changed.map(|at| format!("{:#x}", at + FLASH)), None, "changed");
}

fn stretch(bench: &Bench, address: &str) -> Vec<u8> {
    fs::read(bench.file(&format!("target/dfu/{}-{address}.bin", bench.chip.board))).unwrap()
}

fn f405_over_usb() {
    let bench = Bench::new("f405-usb", &F405);
    bench.run("flash f405 --dfu --elf @image.elf").done();
    // The table last, where the chip starts; nothing in the parameters' sectors.
    assert_eq!(
        bench.calls(),
        [
            "dfu-util -d 0483:df11 --list",
            "dfu-util -d 0483:df11 -a 0 -s 0x0800c000 -D @target/dfu/f405-0x0800c000.bin",
            "dfu-util -d 0483:df11 -a 0 -s 0x08000000:leave -D @target/dfu/f405-0x08000000.bin",
        ]
    );
    assert_eq!(bench.started().as_deref(), Some("0x08000000"));
    flashed(&bench, F405_ERASED);
    let params = 0x4000..0xC000;
    assert!(bench.memory()[params.clone()] == F405.used()[params]);
    // Code, constants and initial values share a sector: one file of whole flash words.
    let code = stretch(&bench, "0x0800c000");
    assert!(
        code.len().is_multiple_of(32) && code.len() < 0x5000,
        "{}",
        code.len()
    );
    assert_eq!(stretch(&bench, "0x08000000").len(), (16 + 82usize) * 4 + 24);
}

fn matek_over_usb() {
    let bench = Bench::new("matek-usb", &MATEK);
    bench.run("flash matek-h743 --dfu --elf @image.elf").done();
    assert_eq!(
        bench.calls(),
        [
            "dfu-util -d 0483:df11 --list",
            "dfu-util -d 0483:df11 -a 0 -s 0x08000000:leave -D @target/dfu/matek-h743-0x08000000.bin",
        ]
    );
    assert_eq!(bench.started().as_deref(), Some("0x08000000"));
    flashed(&bench, MATEK_ERASED);
}

fn by_probe() {
    for (chip, erased) in [(&F405, F405_ERASED), (&MATEK, MATEK_ERASED)] {
        let bench = Bench::new(&format!("probe-{}", chip.board), chip);
        bench
            .run(&format!("flash {} --elf @image.elf", chip.board))
            .done();
        let run = format!(
            "probe-rs run --chip {} --rtt-channel-mode no-block-trim @image.elf",
            chip.name
        );
        assert_eq!(bench.calls(), ["probe-rs list".to_string(), run]);
        flashed(&bench, erased);
        bench.mood("run fails");
        let ended = bench.run(&format!("flash {} --elf @image.elf", chip.board));
        ended.complains(1, "probe-rs failed");
    }
}

fn dry_calls_nothing() {
    let bench = Bench::new("dry", &F405);
    let ended = bench.run("flash f405 --dfu --dry --elf @image.elf");
    ended.done();
    let shown: Vec<_> = ended.stdout.lines().collect();
    assert!(
        shown.len() == 2 && shown.iter().all(|line| line.starts_with("dfu-util -d ")),
        "{shown:?}"
    );
    let ended = bench.run("flash f405 --dry --elf @image.elf");
    assert!(ended.stdout.starts_with("probe-rs run "), "{}", ended.stdout);
    for line in ["backup f405 @a.bin --dry", "backup f405 --dry"] {
        let ended = bench.run(line);
        assert_eq!(
            ended
                .stdout
                .lines()
                .filter(|line| line.starts_with("probe-rs read "))
                .count(),
            2
        );
    }
    assert!(bench.calls().is_empty() && bench.memory() == F405.used() && bench.files("a.bin").is_empty());
}

fn what_is_missing_is_named() {
    let bench = Bench::new("missing", &F405);
    fs::write(bench.file("old.bin"), F405.used()).unwrap();
    for (line, message) in [
        (
            "flash f405 --elf @image.elf",
            "probe-rs is not installed; see https://probe.rs",
        ),
        (
            "flash f405 --dfu --elf @image.elf",
            "dfu-util is not installed; Debian",
        ),
        ("backup f405 @a.bin", "probe-rs is not installed"),
        ("restore f405 @old.bin", "probe-rs is not installed"),
    ] {
        bench.run_bare(line).complains(1, message);
    }
    bench.mood("no probe");
    for line in [
        "flash f405 --elf @image.elf",
        "backup f405 @a.bin",
        "restore f405 @old.bin",
    ] {
        bench.run(line).complains(1, "`probe-rs list` shows no probe");
    }
    assert!(bench.memory() == F405.used() && bench.files("a.bin").is_empty());
    assert_eq!(bench.calls(), ["probe-rs list"; 3]);
}

fn wrong_chip() {
    for (mood, message) in [
        (
            "no device",
            "finds no chip in its USB loader: type `dfu` at its console, or take BOOT0 to 3.3 V",
        ),
        ("no right", "may not open the chip"),
        ("two chips", "2 chips are in their USB loader"),
        (
            "other chip",
            "a f405 has 4 x 16 KiB, 1 x 64 KiB, 7 x 128 KiB: is it another board?",
        ),
    ] {
        let bench = Bench::new(&mood.replace(' ', "-"), &F405);
        bench.mood(mood);
        bench
            .run("flash f405 --dfu --elf @image.elf")
            .complains(1, message);
        assert_eq!(bench.calls(), ["dfu-util -d 0483:df11 --list"], "{mood}");
        assert!(bench.memory() == F405.used(), "{mood}");
    }
}

fn breaks_off() {
    for part in 1..3 {
        let bench = Bench::new(&format!("breaks-{part}"), &F405);
        bench.mood(&format!("download {part} fails"));
        let ended = bench.run("flash f405 --dfu --elf @image.elf");
        ended.complains(
            1,
            &format!("part {part} of 2: the board has no whole firmware now"),
        );
        assert_eq!((bench.calls().len(), bench.started()), (1 + part, None));
        let params = 0x4000..0xC000;
        assert!(bench.memory()[params.clone()] == F405.used()[params]);
        bench.mood("");
        bench.run("flash f405 --dfu --elf @image.elf").done();
        flashed(&bench, F405_ERASED);
    }
}

fn cuav_over_usb() {
    // Its loader is entered by the firmware alone: what a backup would keep is gone by then.
    let bench = Bench::new("cuav-usb", &CUAV);
    bench.mood("no device");
    bench
        .run("flash cuav-v5 --dfu --elf @image.elf")
        .complains(1, "finds no chip in its USB loader: type `dfu` at its console");
    bench.mood("");
    bench.run("flash cuav-v5 --dfu --elf @image.elf").done();
    assert_eq!(bench.started().as_deref(), Some("0x08000000"));
}

fn no_image() {
    let bench = Bench::new("no-image", &F405);
    let refused = |bytes: &[u8], message: &str| {
        fs::write(bench.file("bad.elf"), bytes).unwrap();
        for how in ["", " --dfu"] {
            let ended = bench.run(&format!("flash f405{how} --elf @bad.elf"));
            ended.complains(2, message);
            assert!(
                ended
                    .complaint
                    .ends_with("wanted is what `cargo xtask firmware f405` builds")
            );
        }
    };
    refused(b"no image", "bad.elf: ");
    refused(
        &crate::fixture::image(&MATEK).elf,
        "the vector table has 166 entries, f405 has 98",
    );
    // In the parameters' sector, which would be erased.
    let early = Chip {
        text: 0x0800_3F00,
        ..F405.clone()
    };
    refused(
        &crate::fixture::image(&early).elf,
        "lie in the sectors of the parameters' flash",
    );
    // Without the store of the vector table's address.
    let mut elf = bench.image.elf.clone();
    let store = [0x01, 0x48, 0x02, 0x49, 0x01, 0x60];
    let at = (0..elf.len() - 6).find(|at| elf[*at..*at + 6] == store);
    elf[at.unwrap() + 4..at.unwrap() + 6].copy_from_slice(&[0x00, 0xBF]);
    refused(&elf, "start-up does not take the image's vector table");
    assert!(bench.calls().is_empty() && bench.memory() == F405.used());
}
