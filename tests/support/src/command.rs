//! The `sophie` command in a temporary directory.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// A directory removed after its test.
pub struct Temp(pub PathBuf);

impl Temp {
    /// A new one.
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("sophie-cli-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// Writes a file into it; gives its path.
    pub fn file(&self, name: &str, content: &[u8]) -> String {
        let path = self.0.join(name);
        fs::write(&path, content).unwrap();
        path.display().to_string()
    }
}

impl Drop for Temp {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// The command's file: cargo puts it beside the folder of the test binaries.
fn executable() -> PathBuf {
    let test = std::env::current_exe().unwrap();
    let folder = test.ancestors().nth(2).unwrap();
    folder
        .join("sophie")
        .with_extension(std::env::consts::EXE_EXTENSION)
}

/// The command with these arguments in `directory`.
pub fn command(directory: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(executable());
    command.current_dir(directory).args(args).stdin(Stdio::null());
    command
}

/// What it does there.
pub fn sophie(temp: &Temp, args: &[&str]) -> Output {
    command(&temp.0, args).output().unwrap()
}

/// As text.
pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Requires exit status 2, empty stdout, one line on stderr (returned), no output directory.
pub fn refused(temp: &Temp, args: &[&str]) -> String {
    let output = sophie(temp, args);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {message}");
    assert!(output.stdout.is_empty(), "{args:?}: {}", text(&output.stdout));
    assert!(
        message.ends_with('\n') && message.lines().count() == 1 && message.len() < 500,
        "{args:?}: {message}"
    );
    assert!(!temp.0.join("out").exists(), "{args:?} left an output directory");
    message.trim_end().to_owned()
}
