//! A recording that comes through a named pipe, as from a program that unpacks it.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

use sophie_clock as _;
use sophie_control::params::Params;
use sophie_recording::bytes::{Protocol, decode};
use sophie_recording::replay::{Options, Outcome, replay};
use sophie_recording::truth::Truth;

/// Longer than a reader waits for a pipe's writer.
const PATIENCE: Duration = Duration::from_secs(60);

fn fifo(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("sophie-pipe-{name}-{}", std::process::id()));
    let _ = std::fs::remove_file(&path);
    assert!(Command::new("mkfifo").arg(&path).status().unwrap().success());
    path
}

/// What `work` gives of the pipe at `path`, which is removed then.
fn of<T: Send + 'static>(path: &Path, work: impl FnOnce(&Path) -> T + Send + 'static) -> T {
    let (sender, result) = mpsc::channel();
    let pipe = path.to_owned();
    thread::spawn(move || sender.send(work(&pipe)));
    let result = result.recv_timeout(PATIENCE);
    std::fs::remove_file(path).unwrap();
    result.expect("still reading")
}

fn run(path: &Path) -> Result<Outcome, String> {
    let options = Options {
        params: Params::default(),
        from_s: 0.0,
    };
    replay(path, &options, None)
}

#[test]
fn lines_of_sensors_are_read_through_a_pipe_from_the_first_one_on() {
    let path = fifo("lines");
    let mut text = String::new();
    for i in 0..3_000 {
        writeln!(text, "I,{},0,0,0,0,0,-9.81", 1_000_000 + i * 1_000).unwrap();
    }
    let to = path.clone();
    thread::spawn(move || std::fs::write(to, text));
    assert_eq!(of(&path, run).unwrap().counts[0], 3_000);
}

#[test]
fn a_pipe_without_a_writer_is_refused() {
    let readers: [fn(&Path) -> Option<String>; 3] = [
        |path| run(path).err(),
        |path| decode(path, Protocol::Sbus, &Params::default()).err(),
        |path| Truth::read(path).err(),
    ];
    for reader in readers {
        let why = of(&fifo("unwritten"), reader).unwrap();
        assert!(why.contains("no program writes into this pipe"), "{why}");
    }
}
