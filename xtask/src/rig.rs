//! Builds a board's tests and runs them by a probe or on the emulated board.

use std::path::Path;
use std::process::ExitCode;

use crate::boards::{self, Board};
use crate::build::{Recipe, Variant};
use crate::tools::{self, PROBE_RS};
use crate::{Error, build};

const EMULATED: &str = "matek-h743";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Where {
    Built,
    Emulated,
    Probe,
}

pub struct Rig<'a> {
    pub board: &'static Board,
    on: Where,
    wired: bool,
    variant: Variant,
    /// Parts of test names, for the runner.
    names: Vec<&'a str>,
}

impl<'a> Rig<'a> {
    /// Parses `words` behind the verb.
    ///
    /// # Errors
    /// One line: the fault and the allowed form.
    pub fn parse(words: &[&'a str]) -> Result<Self, String> {
        let [name, rest @ ..] = words else {
            return Err(format!("rig: name the board first: {}", boards::names()));
        };
        let board = boards::find(name)
            .ok_or_else(|| format!("rig: no board is called `{name}`; there are {}", boards::names()))?;
        let mut rig = Self {
            board,
            on: Where::Probe,
            wired: false,
            variant: Variant::Plain,
            names: Vec::new(),
        };
        for &word in rest {
            match (word, rig.on) {
                ("--build", Where::Probe) => rig.on = Where::Built,
                ("--emulated", Where::Probe) => rig.on = Where::Emulated,
                ("--wired", _) => rig.wired = true,
                ("--data-cache", _) => {
                    rig.variant = Variant::DataCache.of(board).map_err(|e| format!("rig: {e}"))?;
                }
                (name, _) if !name.starts_with('-') => rig.names.push(name),
                _ => {
                    return Err(format!(
                        "rig: `{word}` is not understood: allowed are --build or --emulated, --wired, --data-cache, and parts of names of tests"
                    ));
                }
            }
        }
        if rig.on == Where::Emulated && *name != EMULATED {
            return Err(format!("rig: {name} has no emulated rig: allowed is {EMULATED}"));
        }
        Ok(rig)
    }

    /// Builds and runs the tests; returns the runner's exit status.
    ///
    /// # Errors
    /// The tests do not build, their image fails its checks, or no probe is connected.
    pub fn run(&self) -> Result<ExitCode, Error> {
        let wired = self.wired || self.on == Where::Emulated;
        let cached = self.variant == Variant::DataCache;
        let features = format!(
            "sophie-boards/{}{}{}",
            self.board.name,
            if wired { ",wired" } else { "" },
            if cached { ",sophie-boards/data-cache" } else { "" }
        );
        let elf = build::image(&Recipe {
            package: "sophie-rig",
            arguments: &["--test", "rig", "--features", &features],
            variables: &[],
            core: self.board.core,
            kept: &format!("{}{}", self.board.name, if cached { "-data-cache" } else { "" }),
        })?;
        crate::check(self.board, &elf)?;
        match self.on {
            Where::Built => {
                println!("{}", elf.display());
                Ok(ExitCode::SUCCESS)
            }
            Where::Emulated => crate::bench::emulator("rig", [elf.as_os_str()], &self.names),
            Where::Probe => self.probe(&elf),
        }
    }

    fn probe(&self, elf: &Path) -> Result<ExitCode, Error> {
        tools::probe(self.board)?;
        let mut command = PROBE_RS.command(&["run", "--chip", self.board.probe_rs_chip]);
        PROBE_RS.run(command.arg(elf).args(&self.names))?;
        Ok(ExitCode::SUCCESS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_asked_for_is_understood() {
        let rig = Rig::parse(&["matek-h743", "--emulated", "clock", "imu"])
            .ok()
            .unwrap();
        assert!((rig.on, rig.wired) == (Where::Emulated, false) && rig.names == ["clock", "imu"]);
        let rig = Rig::parse(&["f405", "--wired"]).ok().unwrap();
        assert!((rig.on, rig.wired) == (Where::Probe, true) && rig.board.name == "f405");
        for words in [
            &[] as &[&str],
            &["matek"],
            &["cuav-v5", "--emulated"],
            &["f405", "--build", "--emulated"],
            &["f405", "--chip"],
        ] {
            let complaint = Rig::parse(words).err().unwrap_or_default();
            assert!(
                complaint.starts_with("rig: ") && !complaint.contains('\n'),
                "{words:?}"
            );
        }
    }
}
