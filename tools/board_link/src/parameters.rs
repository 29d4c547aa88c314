//! Parameters of a board: written to a file, compared with a file, and set from a file.
//!
//! The file is the `[params]` of a scenario. The console shows and takes numbers with up to nine digits: a difference
//! in the last digit does not count.

use std::fmt::Write;

use sophie_control::maths::decimal::{self, Decimal};
use sophie_control::params::Params;
use sophie_sim::scenario::settings::Setting;

use crate::Failure;
use crate::session::{Session, restarts};

/// Relative rounding error of a number on its way over the console: twice the last bit of 24.
const LAST_DIGIT: f32 = 2.0 * f32::EPSILON;
/// Number of attempts at a list with damaged or missing rows.
const TRIES: u32 = 3;

/// A parameter in the board's working copy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listed {
    /// Its name.
    pub name: String,
    /// The number, as the console shows it.
    pub value: String,
    /// The allowed values, with the unit.
    pub allowed: String,
    /// The value differs from the board's default.
    pub changed: bool,
}

/// A parameter whose value in the file differs from the board's.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Value in the file.
    pub setting: Setting,
    /// Value on the board; `None` if its firmware lacks the parameter.
    pub board: Option<String>,
}

impl Difference {
    /// `infill 6.9 -> 8 %`: from the board's to the file's.
    pub fn text(&self) -> String {
        let row = self.setting.row;
        let new = shown(&self.setting);
        let name = row.choice(self.setting.value).map_or("", |choice| choice.name);
        let mut text = match &self.board {
            Some(old) => format!("{} {old} -> {new}", row.name),
            None => format!(
                "{}: the board has no such parameter, the file has {new}",
                row.name
            ),
        };
        for behind in [name, if row.unit == "1" { "" } else { row.unit }] {
            if !behind.is_empty() {
                let _ = write!(text, " {behind}");
            }
        }
        text
    }
}

/// The number of a setting, as the console shows it.
fn shown(setting: &Setting) -> String {
    Decimal(setting.value).to_string()
}

/// Firmware of the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Version {
    /// Version and board.
    pub firmware: String,
    /// Its image and its table of parameters.
    pub build: String,
}

/// Firmware of the board, by its own answer. Lost lines are asked for again; a firmware without these lines is an
/// earlier one.
///
/// # Errors
/// The line is lost.
pub fn version(session: &mut Session) -> Result<Version, Failure> {
    let (mut firmware, mut build) = (None, None);
    let mut tries = 0..TRIES;
    while (firmware.is_none() || build.is_none()) && tries.next().is_some() {
        let said = session.ask("version")?;
        let line = |begin: &str| said.iter().find(|line| line.starts_with(begin)).cloned();
        firmware = firmware.or_else(|| line("SOPHIE "));
        build = build.or_else(|| line("build "));
    }
    Ok(Version {
        firmware: firmware.unwrap_or_else(|| "an earlier firmware".to_owned()),
        build: build.unwrap_or_else(|| "build unknown".to_owned()),
    })
}

/// The parameters of the board, in its order. Rows that are lost on the way are asked for again, one by one.
///
/// # Errors
/// One line: the line is lost, or the board's answer is not a list.
pub fn listed(session: &mut Session) -> Result<Vec<Listed>, Failure> {
    let mut rows = Vec::new();
    // A row that this program does not know could be lost unnoticed: rows are counted.
    let damaged = take_rows(&session.ask("list")?, &mut rows) > 0;
    if damaged {
        take_rows(&session.ask("list")?, &mut rows);
    }
    for wanted in Params::TABLE {
        let command = format!("list {}", wanted.name);
        let mut tries = 0..TRIES;
        while rows.iter().all(|row| row.name != wanted.name) {
            let said = session.ask(&command)?;
            take_rows(&said, &mut rows);
            // A firmware may know fewer than this program.
            if said.iter().any(|line| line.starts_with("no parameter has '")) {
                break;
            }
            if tries.next().is_none() {
                let port = session.port();
                return Err(Failure::Board(format!(
                    "{port}: '{command}' is damaged on its way each time"
                )));
            }
        }
    }
    let place = |row: &Listed| Params::TABLE.iter().position(|known| known.name == row.name);
    rows.sort_by_key(|row| place(row).unwrap_or(usize::MAX));
    Ok(rows)
}

/// Takes the missing rows out of a list; returns the number of damaged ones.
fn take_rows(lines: &[String], rows: &mut Vec<Listed>) -> usize {
    let read: Vec<Listed> = lines.iter().filter_map(|line| row(line)).collect();
    let damaged = lines.len() - read.len();
    for row in read {
        if rows.iter().all(|known| known.name != row.name) {
            rows.push(row);
        }
    }
    damaged
}

/// One row of `list`: mark, name, number, allowed values.
fn row(line: &str) -> Option<Listed> {
    // Stands for lost or damaged bytes.
    if line.contains('?') {
        return None;
    }
    let changed = match line.split_at_checked(2)?.0 {
        "* " => true,
        "  " => false,
        _ => return None,
    };
    let (name, rest) = line.get(2..)?.split_once(' ')?;
    let (value, allowed) = rest.trim_start().split_once(' ')?;
    decimal::parse(value)?;
    Some(Listed {
        name: name.to_owned(),
        value: value.to_owned(),
        allowed: allowed.trim().to_owned(),
        changed,
    })
}

/// The board's unsaved changes, in its words. An answer that is damaged on its way is asked for again.
///
/// # Errors
/// The line is lost.
pub fn unsaved(session: &mut Session) -> Result<Vec<String>, Failure> {
    let mut tries = 0..TRIES;
    loop {
        let mut lines = session.ask("changes")?;
        // The last line has their number.
        let last = lines.pop().unwrap_or_default();
        if is_whole(&lines, &last) {
            return Ok(lines);
        }
        if tries.next().is_none() {
            let port = session.port();
            return Err(Failure::Board(format!(
                "{port}: 'changes' is answered with '{last}'; expected 'no changes' or their count"
            )));
        }
    }
}

/// The answer to `changes`, whose last line is `last`, has come without damage.
fn is_whole(lines: &[String], last: &str) -> bool {
    let counted = match last.split_once(" change") {
        Some(("no", "s")) => lines.is_empty(),
        Some((count, _)) => count.parse() == Ok(lines.len()),
        None => false,
    };
    counted && lines.iter().all(|line| !line.contains('?'))
}

/// A parameter file with all values of the board; `board` goes into its first lines.
pub fn text(board: &Version, rows: &[Listed]) -> String {
    let Version { firmware, build } = board;
    let mut text = format!(
        "# Parameters of {firmware}, {build}.\n\
         # By `sophie params dump`; `sophie params load` sets them. What a file leaves out stays as it is.\n[params]\n"
    );
    for Listed {
        name,
        value,
        allowed,
        changed,
    } in rows
    {
        let named = Params::row(name)
            .zip(decimal::parse(value))
            .and_then(|(row, value)| row.choice(value))
            .map_or("", |choice| choice.name);
        let value = match named {
            "" => value.clone(),
            named => format!("\"{named}\""),
        };
        let mark = if *changed { "; not the default" } else { "" };
        let _ = writeln!(text, "{:34} # {allowed}{mark}", format!("{name} = {value}"));
    }
    text
}

/// The differences between file and board, in the file's order.
pub fn differences(settings: &[Setting], rows: &[Listed]) -> Vec<Difference> {
    let board = |setting: &Setting| {
        let row = rows.iter().find(|listed| listed.name == setting.row.name);
        row.map(|listed| listed.value.clone())
    };
    let all = settings.iter().map(|setting| Difference {
        setting: *setting,
        board: board(setting),
    });
    all.filter(|difference| {
        let board = difference.board.as_deref().and_then(decimal::parse);
        !board.is_some_and(|board| same(board, difference.setting.value))
    })
    .collect()
}

/// The same number but for its last digit.
fn same(a: f32, b: f32) -> bool {
    (a - b).abs() <= LAST_DIGIT * a.abs().max(b.abs())
}

/// Sets the parameters that differ, saves, and compares those in force after the restart. `say` gets a line for each
/// step.
///
/// # Errors
/// One line: the value that the board refused (its working copy is then put back), or the value that it has instead.
pub fn load(session: &mut Session, settings: &[Setting], say: &mut dyn FnMut(&str)) -> Result<(), Failure> {
    let before = listed(session)?;
    let waiting = unsaved(session)?;
    let port = session.port().to_owned();
    let ours = |line: &str| {
        settings
            .iter()
            .any(|s| line.split(' ').next() == Some(s.row.name))
    };
    if let Some(other) = waiting.iter().find(|line| !ours(line)) {
        return Err(Failure::Board(format!(
            "{port}: the board has a change that is neither saved nor in the file: {other}; \
             'save' or 'restart' at its console first"
        )));
    }
    let different = differences(settings, &before);
    if let Some(absent) = different.iter().find(|difference| difference.board.is_none()) {
        return Err(Failure::Board(format!("{port}: {}", absent.text())));
    }
    if different.is_empty() && waiting.is_empty() {
        say(&format!("nothing to change: all {} are in force", settings.len()));
        return Ok(());
    }
    for difference in &different {
        say(&difference.text());
    }
    for (done, difference) in different.iter().enumerate() {
        if let Err(why) = set(session, difference) {
            return Err(put_back(session, &different[..=done], why));
        }
    }
    // The values are stored already: those in force are still compared.
    session.see_it_through();
    if let Err(why) = save(session) {
        return Err(put_back(session, &different, why));
    }
    say("saved; the board has restarted");
    let now = listed(session)?;
    if let Some(other) = differences(settings, &now).first() {
        return Err(Failure::Board(format!(
            "{port}: read back after the restart: {}",
            other.text()
        )));
    }
    if let Some(line) = unsaved(session)?.first() {
        return Err(Failure::Board(format!(
            "{port}: not in force after the restart: {line}"
        )));
    }
    say(&format!("all {} are in force", settings.len()));
    Ok(())
}

fn set(session: &mut Session, difference: &Difference) -> Result<(), Failure> {
    let name = difference.setting.row.name;
    let command = format!("set {name} {}", shown(&difference.setting));
    let mut said = session.command(&command)?;
    // Lost bytes leave open whether it was taken.
    let mut tries = 1..TRIES;
    while said.iter().any(|line| line.contains('?')) && tries.next().is_some() {
        said = session.command(&command)?;
    }
    let last = said.last().map_or("", String::as_str);
    if last.starts_with(&format!("{name} ")) && last.contains(" -> ") {
        return Ok(());
    }
    let port = session.port();
    Err(Failure::Board(format!(
        "{port}: nothing is saved, the board refused: {last}"
    )))
}

/// Restores the old values in the working copy, as far as the line allows; `why` is the reason for not saving.
fn put_back(session: &mut Session, different: &[Difference], why: Failure) -> Failure {
    let why = match why {
        Failure::Stopped(line) => {
            // If this fails, the next command fails as well.
            let _ = session.calm();
            Failure::Stopped(format!("{line}; nothing is saved"))
        }
        other => other,
    };
    for Difference { setting, board } in different {
        if let Some(old) = board {
            // A failure here is harmless: the working copy ends with the next restart.
            let _ = session.command(&format!("set {} {old}", setting.row.name));
        }
    }
    why
}

/// Stores the working copy and waits for the restarted board.
///
/// # Errors
/// One line: the board's refusal, or the line is lost.
pub fn save(session: &mut Session) -> Result<(), Failure> {
    let said = session.restart("save")?;
    if restarts(&said) {
        return Ok(());
    }
    let (port, last) = (session.port(), said.last().map_or("nothing", String::as_str));
    Err(Failure::Board(format!(
        "{port}: nothing is saved, the board refused: {last}"
    )))
}

#[cfg(test)]
mod tests {
    use sophie_sim::scenario::settings;

    use super::*;

    #[test]
    fn rows_of_a_list_are_read_and_damaged_ones_are_not() {
        let read = row("* infill           8         4 to 10 %").unwrap();
        assert_eq!(
            (&*read.name, &*read.value, &*read.allowed, read.changed),
            ("infill", "8", "4 to 10 %", true)
        );
        for line in [
            "",
            "* ",
            "  infill",
            "  infill           x         4 to 10 %",
            "infill 8 4",
            "? infill 8 4 to 10 %",
        ] {
            assert!(row(line).is_none(), "{line}");
        }
    }

    #[test]
    fn an_answer_to_changes_is_whole_by_its_count_and_without_lost_bytes() {
        let lines = ["infill 6.9 -> 8 %".to_owned()];
        assert!(is_whole(&[], "no changes") && is_whole(&lines, "1 change, save keeps it"));
        assert!(!is_whole(&[], "? changes") && !is_whole(&lines, "2 changes, save keeps them"));
        assert!(!is_whole(&["infill ? -> 8 %".to_owned()], "1 change"));
    }

    #[test]
    fn a_dump_is_read_back_as_what_was_dumped() {
        let rows: Vec<Listed> = Params::TABLE
            .iter()
            .map(|row| Listed {
                name: row.name.to_owned(),
                value: Decimal(row.default).to_string(),
                allowed: sophie_tasks::storage::parameters::Allowed(row).to_string(),
                changed: false,
            })
            .collect();
        let board = Version {
            firmware: "SOPHIE 0.1.0 on matek-h743".to_owned(),
            build: "build 1234abcd".to_owned(),
        };
        let text = text(&board, &rows);
        let read = settings::parse(&text, "dump.toml").unwrap();
        assert_eq!(read.len(), Params::TABLE.len());
        assert!(differences(&read, &rows).is_empty());
        assert!(text.contains("motor_protocol = \"dshot300\""), "{text}");
        assert!(text.lines().all(|line| line.len() <= 160), "{text}");
        let other = settings::parse("[params]\ninfill = 8\nmotor_protocol = \"pwm\"\n", "p.toml").unwrap();
        let texts: Vec<String> = differences(&other, &rows).iter().map(Difference::text).collect();
        assert_eq!(texts, ["infill 6.9 -> 8 %", "motor_protocol 300 -> 400 pwm"]);
        // A neighbour in the last bit is the same; the next digit is not.
        let file = settings::parse("[params]\ninertia_pitch = 0.04356\n", "p.toml").unwrap();
        for (shown, differs) in [("0.04356", 0), ("0.04356000", 0), ("0.0435601", 1)] {
            let row = Listed {
                name: "inertia_pitch".to_owned(),
                value: shown.to_owned(),
                allowed: String::new(),
                changed: true,
            };
            assert_eq!(differences(&file, &[row]).len(), differs, "{shown}");
        }
        let absent = differences(&other, &[]);
        assert_eq!(
            absent[0].text(),
            "infill: the board has no such parameter, the file has 8 %"
        );
    }
}
