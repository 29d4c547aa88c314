//! `cargo xtask backup` and `restore`.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use libtest_mimic::Trial;

use crate::bench::{Bench, trial};
use crate::chips::{CUAV, F405, MATEK};

pub fn tests() -> Vec<Trial> {
    vec![
        trial("there_and_back", there_and_back),
        trial("a_backup_is_never_overwritten", never_overwritten),
        trial("a_read_that_fails_leaves_nothing", fails),
        trial("a_backup_that_is_cut_off_leaves_nothing_under_its_name", cut_off),
        trial("a_blank_chip_has_nothing_to_keep", blank),
        trial("what_is_no_backup_is_not_restored", no_backup),
        trial("the_cuav_is_not_flashed_without_backup", cuav_first),
    ]
}

fn there_and_back() {
    for chip in [&CUAV, &F405, &MATEK] {
        let bench = Bench::new(&format!("back-{}", chip.board), chip);
        let (board, name) = (chip.board, chip.name);
        let ended = bench.run(&format!("backup {board} @kept/old.bin"));
        ended.done();
        assert!(
            ended.stdout.trim_end().ends_with("kept/old.bin"),
            "{}",
            ended.stdout
        );
        let words = chip.size() / 4;
        let read = format!("probe-rs read --chip {name} --format binary --output @kept/old.bin");
        let [part, again] = ["part", "again"].map(|end| format!("{read}.{end} b32 0x08000000 {words}"));
        assert_eq!(bench.calls(), ["probe-rs list".to_string(), part, again]);
        assert!(fs::read(bench.file("kept/old.bin")).unwrap() == chip.used());
        assert_eq!(fs::read_dir(bench.file("kept")).unwrap().count(), 1);

        bench
            .run(&format!("flash {board} --elf @image.elf --backup @kept/old.bin"))
            .done();
        assert!(bench.memory() != chip.used());
        bench.calls();
        bench.run(&format!("restore {board} @kept/old.bin")).done();
        let download = format!(
            "probe-rs download --chip {name} --binary-format bin --base-address 0x08000000 --verify @kept/old.bin"
        );
        let reset = format!("probe-rs reset --chip {name}");
        assert_eq!(bench.calls(), ["probe-rs list".to_string(), download, reset]);
        assert!(bench.memory() == chip.used());
        assert_eq!(bench.started().as_deref(), Some("reset"));
    }
}

fn never_overwritten() {
    let bench = Bench::new("overwrite", &F405);
    fs::write(bench.file("a.bin"), "precious").unwrap();
    bench
        .run("backup f405 @a.bin")
        .complains(2, "is there already and is not overwritten");
    assert!(bench.calls().is_empty());
    assert_eq!(fs::read(bench.file("a.bin")).unwrap(), b"precious");
}

fn fails() {
    let bench = Bench::new("fails", &F405);
    for (mood, message) in [
        ("read 1 fails", "probe-rs failed"),
        ("read 2 fails", "probe-rs failed"),
        ("short read", "has 524288 bytes; wanted are the 1048576 bytes"),
        ("reads differ", "two reads differ at 0x080ffffd"),
    ] {
        bench.mood(mood);
        bench.run("backup f405 @a.bin").complains(1, message);
        assert_eq!(bench.files("a.bin"), [""; 0], "{mood}");
        bench.calls();
    }
}

fn cut_off() {
    let bench = Bench::new("cut-off", &F405);
    bench.mood("read hangs");
    let mut command = bench.command("backup f405 @a.bin");
    let mut running = command.stderr(Stdio::null()).spawn().unwrap();
    let half = |name: &str| fs::metadata(bench.file(name)).is_ok_and(|about| about.len() == 524_288);
    let begun = Instant::now();
    while !half("a.bin.part") && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(20));
    }
    running.kill().unwrap();
    running.wait().unwrap();
    assert!(half("a.bin.part"));
    assert!(!bench.file("a.bin").exists());
    // An unfinished backup is no obstacle.
    bench.mood("");
    bench.calls();
    bench.run("backup f405 @a.bin").done();
    assert_eq!(bench.files("a.bin"), ["a.bin"]);
    assert!(fs::read(bench.file("a.bin")).unwrap() == F405.used());
}

fn blank() {
    let bench = Bench::new("blank", &F405);
    fs::write(bench.file("flash.bin"), vec![0xFF; F405.size()]).unwrap();
    let ended = bench.run("backup f405 @a.bin");
    ended.complains(
        1,
        "begins with 0xffffffff 0xffffffff, which starts no STM32F405RGTx",
    );
    assert_eq!(bench.files("a.bin"), [""; 0]);
}

fn no_backup() {
    let bench = Bench::new("no-backup", &F405);
    let short = F405.used()[1..].to_vec();
    let mut other = F405.used();
    other[..8].fill(0);
    for (name, bytes, message) in [
        (
            "short.bin",
            short,
            "has 1048575 bytes; wanted are the 1048576 bytes",
        ),
        (
            "larger.bin",
            MATEK.used(),
            "has 2097152 bytes; wanted are the 1048576 bytes",
        ),
        (
            "other.bin",
            other,
            "begins with 0x00000000 0x00000000, which starts no STM32F405RGTx",
        ),
    ] {
        fs::write(bench.file(name), bytes).unwrap();
        for dry in ["", " --dry"] {
            bench
                .run(&format!("restore f405 @{name}{dry}"))
                .complains(2, message);
        }
    }
    bench
        .run("restore f405 @absent.bin")
        .complains(2, "absent.bin: cannot be read");
    bench.run("restore f405 @path").complains(2, "has 0 bytes");
    assert!(bench.calls().is_empty() && bench.memory() == F405.used());

    fs::write(bench.file("old.bin"), F405.used()).unwrap();
    bench.mood("download fails");
    bench
        .run("restore f405 @old.bin")
        .complains(1, "the flash of the f405 may be half written; repeat");
    assert_eq!(bench.started(), None);
}

fn cuav_first() {
    let bench = Bench::new("cuav-first", &CUAV);
    let flash = "flash cuav-v5 --elf @image.elf";
    let refused = |message: &str| {
        let ended = bench.run(&format!("{flash} --backup @old.bin"));
        ended.complains(2, "flash: this overwrites the only loader of the cuav-v5");
        ended.complains(2, message);
        assert!(
            ended.complaint.contains("`cargo xtask backup cuav-v5`"),
            "{}",
            ended.complaint
        );
        assert!(bench.calls().is_empty() && bench.memory() == CUAV.used());
    };
    refused("old.bin: cannot be read");
    fs::write(bench.file("old.bin"), F405.used()).unwrap();
    refused("has 1048576 bytes");
    fs::write(bench.file("old.bin"), vec![0xFF; CUAV.size()]).unwrap();
    refused("starts no STM32F765IITx");
    fs::write(bench.file("old.bin"), CUAV.used()).unwrap();
    bench.run(&format!("{flash} --backup @old.bin")).done();
    bench.run(&format!("{flash} --no-backup")).done();
    assert_eq!(bench.calls().len(), 4);
    // Others are restored over USB with their makers' firmware.
    for chip in [&F405, &MATEK] {
        let bench = Bench::new(&format!("free-{}", chip.board), chip);
        bench
            .run(&format!("flash {} --elf @image.elf", chip.board))
            .done();
    }
}
