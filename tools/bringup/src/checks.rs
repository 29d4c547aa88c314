//! Chip, setup, self-tests, and the final check.

use super::protocol::Identity;
use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};
use sophie_board_link::Failure;
use sophie_board_link::parameters::{self, Version};
use sophie_board_link::session::{Session, restarts};

/// Parameters of the parts, which the builder enters; the rest have good defaults or are measured.
const SETUP: [&str; 7] = [
    "motor_protocol",
    "rc_protocol",
    "battery_capacity",
    "battery_warning",
    "battery_critical",
    "infill",
    // Before any servo moves: its angles follow from it.
    "servo_range",
];
/// Pulse ends of motor controllers that take pulses.
const PULSES: [&str; 3] = ["motor_pulse_min", "motor_pulse_idle", "motor_pulse_max"];
/// Text of `status` for a storage that a save repairs.
const UNSOUND: [&str; 3] = [
    "stored parameters unreadable",
    "storage holds another firmware's data",
    "parameter storage full",
];
/// Row of `silicon` that fails with such a storage; the setup clears it.
const STORED: &str = "stored data of";
const BROWN_OUT: &str = "brown-out level";
/// Rows of the self-test that may fail while their parts are unpowered.
const STILL_OFF: [&str; 2] = ["receiver", "battery"];

/// A row of `silicon`.
struct Look {
    name: String,
    read: String,
    marked: bool,
}

/// The rows of `silicon`: mark, name, value, expected value.
fn looks(session: &mut Session) -> Result<Vec<Look>, Failure> {
    let said = session.command("silicon")?;
    let looks = said.iter().filter_map(|line| {
        let (found, _) = line.split_once("expected:")?;
        let name = found.get(2..22)?.trim().to_owned();
        let read = found.get(22..)?.trim().to_owned();
        let marked = line.starts_with('*');
        Some(Look { name, read, marked })
    });
    Ok(looks.collect())
}

/// Firmware and chip of the board.
pub(super) fn identity(session: &mut Session) -> Result<Identity, Failure> {
    let Version { firmware, build } = parameters::version(session)?;
    let looks = looks(session)?;
    let revision = looks.into_iter().find(|look| look.name == "revision");
    Ok(Identity {
        firmware,
        build,
        chip: revision.map_or_else(|| "unknown".to_owned(), |look| look.read),
    })
}

pub(super) fn chip(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let found = looks(walk.session)?;
    if found.iter().any(|look| look.marked && look.name == BROWN_OUT) {
        for line in walk.session.command("brownout")? {
            walk.say(&format!("  | {line}"));
        }
        walk.ask("Enter sets it, once for this chip, s skips, q stops:")?;
        let said = walk.session.restart("brownout set")?;
        if !restarts(&said) {
            return Ok(Verdict::of(false, said));
        }
        walk.ready()?;
    }
    let found = looks(walk.session)?;
    let line = |look: &Look| {
        let mark = if look.marked { ", not as expected" } else { "" };
        format!("{}: {}{mark}", look.name, look.read)
    };
    let sound = found.iter().all(|look| !look.marked || look.name == STORED);
    Ok(Verdict::of(
        sound && !found.is_empty(),
        found.iter().map(line).collect(),
    ))
}

pub(super) fn setup(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let mut said = Vec::new();
    for name in SETUP {
        said.push(set_up(walk, name)?);
        if name == "motor_protocol" && takes_pulses(walk.session)? {
            for name in PULSES {
                said.push(set_up(walk, name)?);
            }
        }
    }
    let status = walk.ready()?;
    let unsound = status
        .iter()
        .find(|line| UNSOUND.iter().any(|text| line.contains(text)));
    if let Some(line) = unsound {
        walk.say(&format!("  | {line}"));
        walk.ask("Enter erases what cannot be read and stores these, s skips, q stops:")?;
        walk.user
            .say("  saving; the board restarts: leave the vehicle at rest");
        parameters::save(walk.session)?;
        walk.ready()?;
    }
    let kept = walk.keep(&said)?;
    let pulses = takes_pulses(walk.session)?;
    let rows = parameters::listed(walk.session)?;
    let asked = |name: &str| SETUP.contains(&name) || pulses && PULSES.contains(&name);
    let rows = rows.into_iter().filter(|listed| asked(&listed.name));
    let rows: Vec<parameters::Listed> = rows.collect();
    let figures = rows
        .iter()
        .map(|listed| format!("{} {}", listed.name, listed.value));
    let mut verdict = Verdict::of(true, figures.collect());
    verdict.parameters = kept;
    Ok(verdict)
}

/// True if the motor controllers take pulses, by the parameters.
pub(super) fn takes_pulses(session: &mut Session) -> Result<bool, Failure> {
    let rows = parameters::listed(session)?;
    let protocol = rows.iter().find(|listed| listed.name == "motor_protocol");
    Ok(protocol.is_some_and(|listed| matches!(&*listed.value, "400" | "125")))
}

/// Shows a parameter and takes another value for it; returns the console's line of the change, empty without one.
fn set_up(walk: &mut Walk<'_>, name: &str) -> Result<String, Stop> {
    for line in walk.session.command(&format!("get {name}"))? {
        walk.say(&format!("  | {}", line.trim()));
    }
    loop {
        let value = walk.ask(&format!("Enter keeps {name}, or type another value:"))?;
        if value.is_empty() {
            return Ok(String::new());
        }
        let said = walk.session.command(&format!("set {name} {value}"))?.join("; ");
        walk.say(&format!("  | {said}"));
        if said.contains(" -> ") {
            return Ok(said);
        }
    }
}

/// The table, and the names of the rows that fail.
fn tested(walk: &mut Walk<'_>) -> Result<(Vec<String>, Vec<String>), Stop> {
    walk.ready()?;
    let said = walk.session.command("selftest")?;
    let failed = said
        .iter()
        .filter_map(|line| Some(line.strip_prefix("FAIL  ")?.get(..18)?.trim().to_owned()));
    let failed = failed.collect();
    Ok((said, failed))
}

pub(super) fn selftest(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let (said, failed) = tested(walk)?;
    let passed = complete(&said) && failed.iter().all(|name| STILL_OFF.contains(&&**name));
    Ok(Verdict::of(passed, said))
}

/// The table has its last line.
fn complete(said: &[String]) -> bool {
    said.last()
        .is_some_and(|line| line.ends_with(" passed") || line.ends_with(" failed"))
}

pub(super) fn everything(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let (mut said, failed) = tested(walk)?;
    let sound = complete(&said) && failed.is_empty();
    let status = walk.ready()?;
    let free = status.iter().any(|line| line == "nothing forbids arming");
    let forbids = |line: &&String| line.starts_with("arming refused") || *line == "nothing forbids arming";
    said.extend(status.iter().filter(forbids).cloned());
    let unsaved = parameters::unsaved(walk.session)?;
    said.extend(unsaved.iter().map(|line| format!("not saved: {line}")));
    let rows = parameters::listed(walk.session)?;
    let other = rows.iter().filter(|listed| listed.changed);
    said.extend(other.map(|listed| format!("not the default: {} {}", listed.name, listed.value)));
    Ok(Verdict::of(sound && free && unsaved.is_empty(), said))
}
