//! A folder with a board's flash, the stand-ins, and xtask.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;
use std::process::{Command, Output};

use libtest_mimic::Trial;

use crate::chips::Chip;
use crate::fixture::{self, Fixture};
use crate::stand_ins::{BOARD, CALLS, FOLDER, MEMORY, MOOD, STARTED};

pub fn trial(name: &str, test: fn()) -> Trial {
    Trial::test(name, move || {
        test();
        Ok(())
    })
}

pub struct Bench {
    pub chip: &'static Chip,
    pub image: Fixture,
    folder: PathBuf,
}

pub struct Ended {
    pub status: Option<i32>,
    pub stdout: String,
    pub complaint: String,
}

impl Bench {
    /// A used board; `name` is the test's.
    pub fn new(name: &str, chip: &'static Chip) -> Self {
        let folder = std::env::temp_dir().join(format!("xtask-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("path")).unwrap();
        for program in ["dfu-util", "probe-rs"] {
            symlink(
                std::env::current_exe().unwrap(),
                folder.join("path").join(program),
            )
            .unwrap();
        }
        let image = fixture::image(chip);
        fs::write(folder.join(MEMORY), chip.used()).unwrap();
        fs::write(folder.join(BOARD), chip.board).unwrap();
        fs::write(folder.join("image.elf"), &image.elf).unwrap();
        Self { chip, image, folder }
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Sets an error mode of the stand-ins.
    pub fn mood(&self, mood: &str) {
        fs::write(self.file(MOOD), mood).unwrap();
    }

    /// xtask with the words of a line; `@` is the bench's folder.
    pub fn command(&self, line: &str) -> Command {
        let folder = format!("{}/", self.folder.display());
        let words = line.split(' ').map(|word| word.replace('@', &folder));
        let mut command = Command::new(env!("CARGO_BIN_EXE_xtask"));
        command.args(words).env(FOLDER, &self.folder);
        command
            .env("PATH", self.file("path"))
            .env("CARGO_TARGET_DIR", self.file("target"));
        command
    }

    pub fn run(&self, line: &str) -> Ended {
        ended(self.command(line).output().unwrap())
    }

    /// Runs it without any program installed.
    pub fn run_bare(&self, line: &str) -> Ended {
        ended(self.command(line).env("PATH", "/nowhere").output().unwrap())
    }

    /// Takes the calls so far, with `@` for the folder.
    pub fn calls(&self) -> Vec<String> {
        let calls = fs::read_to_string(self.file(CALLS)).unwrap_or_default();
        let _ = fs::remove_file(self.file(CALLS));
        let folder = format!("{}/", self.folder.display());
        calls.lines().map(|line| line.replace(&folder, "@")).collect()
    }

    pub fn memory(&self) -> Vec<u8> {
        fs::read(self.file(MEMORY)).unwrap()
    }

    /// Address at which the loader started the firmware, or `reset`.
    pub fn started(&self) -> Option<String> {
        fs::read_to_string(self.file(STARTED)).ok()
    }

    pub fn files(&self, name: &str) -> Vec<String> {
        let entries = fs::read_dir(&self.folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<_> = names.filter(|found| found.starts_with(name)).collect();
        names.sort();
        names
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            let _ = fs::remove_dir_all(&self.folder);
        }
    }
}

impl Ended {
    /// Requires `status` and one line with `message`.
    pub fn complains(&self, status: i32, message: &str) {
        assert_eq!(self.status, Some(status), "{}", self.complaint);
        assert!(self.complaint.contains(message), "{}", self.complaint);
    }

    pub fn done(&self) {
        assert_eq!(self.status, Some(0), "{}", self.complaint);
    }
}

fn ended(output: Output) -> Ended {
    let [stdout, stderr] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    Ended {
        status: output.status.code(),
        stdout,
        complaint: stderr.lines().last().unwrap_or_default().to_string(),
    }
}
