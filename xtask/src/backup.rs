//! Backup of a board's flash in a file, and its restoration: the way back to the former firmware.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::boards::{self, Board, FLASH};
use crate::build::typed;
use crate::tools::{self, PROBE_RS};
use crate::{Error, Refused, build};

pub struct Backup<'a> {
    pub board: &'static Board,
    file: Option<&'a str>,
    dry: bool,
}

impl<'a> Backup<'a> {
    /// Parses `words` behind `verb`.
    ///
    /// # Errors
    /// One line: the fault and the allowed form.
    pub fn parse(verb: &str, words: &[&'a str]) -> Result<Self, String> {
        let [name, rest @ ..] = words else {
            return Err(format!("{verb}: name the board first: {}", boards::names()));
        };
        let board = boards::find(name).ok_or_else(|| {
            format!(
                "{verb}: no board is called `{name}`; there are {}",
                boards::names()
            )
        })?;
        let mut backup = Self {
            board,
            file: None,
            dry: false,
        };
        for &word in rest {
            match word {
                "--dry" => backup.dry = true,
                _ if word.starts_with('-') => {
                    return Err(format!(
                        "{verb}: `{word}` is not understood: allowed are a FILE and --dry"
                    ));
                }
                _ if backup.file.is_some() => {
                    return Err(format!("{verb}: `{word}` is a second file: allowed is one"));
                }
                _ => backup.file = Some(word),
            }
        }
        if verb == "restore" && backup.file.is_none() {
            return Err(format!(
                "restore: name the FILE that `cargo xtask backup {name}` wrote"
            ));
        }
        Ok(backup)
    }

    fn path(&self) -> PathBuf {
        self.file.map_or_else(|| usual(self.board), PathBuf::from)
    }

    /// Reads the whole flash twice and keeps it if both are equal.
    ///
    /// # Errors
    /// The file exists; no probe; probe-rs fails or reads nothing that could be restored.
    pub fn save(&self) -> Result<(), Error> {
        let path = self.path();
        if !self.dry && path.symlink_metadata().is_ok() {
            return Err(Refused(format!(
                "backup: {} is there already and is not overwritten; name another FILE",
                typed(&path)
            ))
            .into());
        }
        let parts = ["part", "again"].map(|end| path.with_added_extension(end));
        let commands = parts.each_ref().map(|part| read(self.board, part));
        if self.dry {
            commands
                .iter()
                .for_each(|command| println!("{}", build::shown(command)));
            return Ok(());
        }
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            fs::create_dir_all(folder).map_err(|e| format!("backup: {}: {e}", typed(folder)))?;
        }
        tools::probe(self.board)?;
        let kept = keep(self.board, commands, &parts, &path);
        for part in &parts {
            // The first is gone if it became the backup.
            let _ = fs::remove_file(part);
        }
        kept?;
        println!("{}", typed(&path));
        Ok(())
    }

    /// Writes the file over the whole flash.
    ///
    /// # Errors
    /// The file cannot be a backup of this board; no probe; probe-rs fails.
    pub fn restore(&self) -> Result<(), Error> {
        let path = self.path();
        sound(self.board, &path).map_err(|why| Refused(format!("restore: {why}")))?;
        let address = format!("{FLASH:#010x}");
        let chip = ["--chip", self.board.probe_rs_chip];
        let mut write = PROBE_RS.command(&["download", chip[0], chip[1], "--binary-format", "bin"]);
        write.args(["--base-address", &address, "--verify"]).arg(&path);
        let mut start = PROBE_RS.command(&["reset", chip[0], chip[1]]);
        if self.dry {
            println!("{}\n{}", build::shown(&write), build::shown(&start));
            return Ok(());
        }
        tools::probe(self.board)?;
        PROBE_RS.run(&mut write).map_err(|e| {
            format!(
                "restore: {e}: the flash of the {} may be half written; repeat",
                self.board.name
            )
        })?;
        PROBE_RS.run(&mut start)
    }
}

/// Default path of a board's backup.
pub fn usual(board: &Board) -> PathBuf {
    build::root().join("backups").join(format!("{}.bin", board.name))
}

/// Checks that [`Backup::restore`] accepts the file.
///
/// # Errors
/// The file's fault, and the requirement.
pub fn sound(board: &Board, path: &Path) -> Result<(), String> {
    let wanted = format!(
        "wanted are the {} bytes that `cargo xtask backup {}` writes",
        board.flash_size(),
        board.name
    );
    let shown = typed(path);
    let unread = |e| format!("{shown}: cannot be read ({e}); {wanted}");
    let about = fs::metadata(path).map_err(unread)?;
    if !about.is_file() || about.len() != board.flash_size() {
        let what = if about.is_file() { about.len() } else { 0 };
        return Err(format!("{shown} has {what} bytes; {wanted}"));
    }
    let mut head = [0; 8];
    let mut file = File::open(path).map_err(unread)?;
    file.read_exact(&mut head).map_err(unread)?;
    let [stack, reset] = [0, 4].map(|at| u32::from_le_bytes(std::array::from_fn(|n| head[at + n])));
    // A core starts with a stack in RAM and a Thumb address in flash.
    let flash = FLASH..FLASH + board.flash_size();
    if (0x1000_0000..0x4000_0000).contains(&stack) && reset % 2 == 1 && flash.contains(&u64::from(reset)) {
        Ok(())
    } else {
        Err(format!(
            "{shown} begins with {stack:#010x} {reset:#010x}, which starts no {}: no firmware to bring back; {wanted}",
            board.probe_rs_chip
        ))
    }
}

fn read(board: &Board, file: &Path) -> Command {
    let [address, words] = [format!("{FLASH:#010x}"), (board.flash_size() / 4).to_string()];
    let mut command = PROBE_RS.command(&["read", "--chip", board.probe_rs_chip, "--format", "binary"]);
    command.arg("--output").arg(file).args(["b32", &address, &words]);
    command
}

fn keep(board: &Board, commands: [Command; 2], parts: &[PathBuf; 2], path: &Path) -> Result<(), Error> {
    for (mut command, part) in commands.into_iter().zip(parts) {
        PROBE_RS
            .run(&mut command)
            .map_err(|e| format!("backup: {e}; `probe-rs read` writes files from release 0.29 on"))?;
        sound(board, part).map_err(|why| format!("backup: {why}"))?;
    }
    let [first, second] = [fs::read(&parts[0])?, fs::read(&parts[1])?];
    if let Some(at) = first.iter().zip(&second).position(|(a, b)| a != b) {
        return Err(format!(
            "backup: two reads differ at {:#010x}: slow the probe down (PROBE_RS_SPEED=400) and repeat",
            FLASH + at as u64
        )
        .into());
    }
    File::open(&parts[0])?.sync_all()?;
    fs::rename(&parts[0], path).map_err(|e| format!("backup: {}: {e}", typed(path)).into())
}
