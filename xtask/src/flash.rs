//! Flashes a board by a probe, or through the chip's USB loader.

use std::path::{Path, PathBuf};

use crate::boards::{self, Board, UsbLoader};
use crate::build::{self, Variant};
use crate::tools::{self, PROBE_RS};
use crate::{Error, Refused, backup, dfu};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum By {
    Probe,
    Usb,
}

/// Backup required before flashing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Before<'a> {
    /// A backup at the default path.
    Usual,
    File(&'a str),
    /// None, by the user's choice.
    Nothing,
}

pub struct Flash<'a> {
    pub board: &'static Board,
    by: By,
    variant: Variant,
    /// The image; `None`: to be built.
    elf: Option<&'a str>,
    before: Before<'a>,
    dry: bool,
}

impl<'a> Flash<'a> {
    /// Parses `words` behind the verb.
    ///
    /// # Errors
    /// One line: the fault and the allowed form.
    pub fn parse(words: &[&'a str]) -> Result<Self, String> {
        let mut names = Vec::new();
        let (mut by, mut variant, mut elf) = (By::Probe, Variant::Plain, None);
        let (mut before, mut dry) = (Before::Usual, false);
        let mut rest = words.iter().copied();
        while let Some(word) = rest.next() {
            let mut file = || {
                let value = rest.next().filter(|value| !value.starts_with('-'));
                value.ok_or_else(|| format!("flash: `{word}` lacks its FILE"))
            };
            match word {
                "--dfu" => by = By::Usb,
                "--elf" => elf = Some(file()?),
                "--backup" => before = Before::File(file()?),
                "--no-backup" => before = Before::Nothing,
                "--dry" => dry = true,
                _ if Variant::asked(word).is_some() => {
                    let asked = Variant::asked(word).unwrap_or(Variant::Plain);
                    if std::mem::replace(&mut variant, asked) != Variant::Plain {
                        return Err(format!(
                            "flash: `{word}` is a second kind of image: allowed is one"
                        ));
                    }
                }
                _ if word.starts_with('-') => {
                    return Err(format!(
                        "flash: `{word}` is not understood: allowed are --dfu, --trace, --data-cache, --elf FILE, --backup FILE, \
                         --no-backup, --dry"
                    ));
                }
                _ => names.push(word),
            }
        }
        let [name] = names[..] else {
            return Err(format!("flash: name exactly one board: {}", boards::names()));
        };
        let board = boards::find(name).ok_or_else(|| {
            format!(
                "flash: no board is called `{name}`; there are {}",
                boards::names()
            )
        })?;
        if elf.is_some() && variant != Variant::Plain {
            return Err(
                "flash: --elf excludes --trace and --data-cache: the image is built or it is given".into(),
            );
        }
        Ok(Self {
            board,
            by,
            variant: variant.of(board).map_err(|e| format!("flash: {e}"))?,
            elf,
            before,
            dry,
        })
    }

    /// Builds or reads the image, checks it and flashes it.
    ///
    /// # Errors
    /// No backup, no way to the board, or a failure of the image's checks, probe, loader or a program.
    pub fn run(&self) -> Result<(), Error> {
        if !self.dry {
            self.backed_up()?;
        }
        let elf = match self.elf {
            Some(given) => PathBuf::from(given),
            None => build::firmware(self.board, self.variant)?,
        };
        let image = crate::check(self.board, &elf).map_err(|e| match self.elf {
            Some(given) => Error::from(Refused(format!(
                "flash: {given}: {e}; wanted is what `cargo xtask firmware {}` builds",
                self.board.name
            ))),
            None => e,
        })?;
        match self.by {
            By::Probe => self.by_probe(&elf),
            By::Usb => dfu::flash(self.board, &image, self.dry),
        }
    }

    /// Requires a backup where this firmware alone enters the chip's own loader: flashing by a probe overwrites the flash's
    /// loader, the only way back to the original firmware. Over USB it is gone already.
    fn backed_up(&self) -> Result<(), Refused> {
        if self.before == Before::Nothing
            || self.by == By::Usb
            || matches!(self.board.usb_loader, UsbLoader::Enter(_))
        {
            return Ok(());
        }
        let usual = backup::usual(self.board);
        let file = match self.before {
            Before::File(file) => Path::new(file),
            _ => &usual,
        };
        backup::sound(self.board, file).map_err(|why| {
            Refused(format!(
                "flash: this overwrites the only loader of the {}: {why}; say --backup FILE for another file, or \
                 --no-backup to do without",
                self.board.name
            ))
        })
    }

    fn by_probe(&self, elf: &Path) -> Result<(), Error> {
        let mut command = PROBE_RS.command(&["run", "--chip", self.board.probe_rs_chip]);
        // The firmware drops log lines rather than wait for a probe, which must not make it wait.
        command.args(["--rtt-channel-mode", "no-block-trim"]).arg(elf);
        if self.dry {
            println!("{}", build::shown(&command));
            return Ok(());
        }
        tools::probe(self.board)?;
        PROBE_RS.run(&mut command)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_understood() {
        let flash = Flash::parse(&["f405"]).ok().unwrap();
        assert_eq!(
            (flash.by, flash.variant, flash.dry),
            (By::Probe, Variant::Plain, false)
        );
        assert_eq!((flash.elf, flash.before), (None, Before::Usual));
        let flash = Flash::parse(&["--dfu", "--elf", "a.elf", "f405", "--backup", "b.bin", "--dry"]);
        let flash = flash.ok().unwrap();
        assert_eq!((flash.by, flash.elf, flash.dry), (By::Usb, Some("a.elf"), true));
        assert_eq!(flash.before, Before::File("b.bin"));
        for words in [
            &[] as &[&str],
            &["matek"],
            &["f405", "matek-h743"],
            &["f405", "--elf"],
            &["f405", "--elf", "--dfu"],
            &["f405", "--elf", "a.elf", "--trace"],
            &["f405", "--dfuse"],
        ] {
            let complaint = Flash::parse(words).err().unwrap_or_default();
            assert!(
                complaint.starts_with("flash: ") && !complaint.contains('\n'),
                "{words:?}"
            );
        }
    }
}
