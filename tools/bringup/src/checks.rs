//! Chip, setup, self-tests, and the final check.

use std::collections::BTreeMap;

use sophie_board_link::Failure;
use sophie_board_link::vehicle::{Identity, Vehicle, inhibits};
use sophie_control::allocation::motor_pulses::by_pulses;
use sophie_control::arming::ArmingInhibit;
use sophie_control::maths::decimal;
use sophie_control::params::Params;
use sophie_dialect::{MavCmd, MavMessage, MavResult, SOPHIE_CHECK_DATA, SophieReport};
use sophie_tasks::storage::parameters::{Allowed, Shown, Unit, table_id};

use super::protocol;
use super::walk::{Stop, Verdict, Walk, number};
use super::{Judged, Step};

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
/// State of a storage that is repaired by storing.
const UNSOUND: [ArmingInhibit; 3] = [
    ArmingInhibit::StorageUnreadable,
    ArmingInhibit::StorageForeign,
    ArmingInhibit::StorageFull,
];
/// Rows of the self-test that may fail while their parts are unpowered.
const STILL_OFF: [ArmingInhibit; 3] = [
    ArmingInhibit::RcLost,
    ArmingInhibit::BatterySilent,
    ArmingInhibit::BatteryLow,
];
/// Number of attempts at a report that loses rows on its way.
const TRIES: u32 = 3;

/// A row of a report.
struct Row {
    name: String,
    found: String,
    passed: bool,
    /// Arming checks that belong to it.
    inhibits: Vec<ArmingInhibit>,
}

impl Row {
    fn of(row: &SOPHIE_CHECK_DATA) -> Self {
        Self {
            name: row.name.to_str().unwrap_or_default().to_owned(),
            found: row.found.to_str().unwrap_or_default().to_owned(),
            passed: row.passed != 0,
            inhibits: inhibits(row.inhibits),
        }
    }

    /// One of `these` belongs to it.
    fn concerns(&self, these: &[ArmingInhibit]) -> bool {
        self.inhibits.iter().any(|inhibit| these.contains(inhibit))
    }

    fn line(&self) -> String {
        let verdict = if self.passed { "pass" } else { "FAIL" };
        format!("{verdict}  {:20} {}", self.name, self.found)
    }
}

/// All rows of a report; the vehicle's reason if it refuses. Rows that are lost on their way are taken from its
/// repetition.
fn report(walk: &mut Walk<'_>, report: SophieReport) -> Result<Result<Vec<Row>, String>, Stop> {
    let which = report as u8;
    let mut rows = BTreeMap::new();
    let mut count = None;
    for _ in 0..TRIES {
        let params = [f32::from(which)];
        let result = walk
            .vehicle
            .command_with(MavCmd::MAV_CMD_SOPHIE_REPORT, &params, |message| {
                if let MavMessage::SOPHIE_CHECK(row) = message
                    && row.report == which
                {
                    count = Some(usize::from(row.rows));
                    rows.insert(row.row, Row::of(row));
                }
            })?;
        if result != MavResult::MAV_RESULT_ACCEPTED {
            let reason = walk.vehicle.reason()?;
            return Ok(Err(format!("no report: {reason}")));
        }
        if count == Some(rows.len()) {
            return Ok(Ok(rows.into_values().collect()));
        }
    }
    Ok(match count {
        None => Ok(Vec::new()),
        Some(count) => Err(format!(
            "of {count} rows of the report {} have come: the line loses too much",
            rows.len()
        )),
    })
}

/// Firmware and chip of the board, and a warning where its parameters are not those of this program.
pub(super) fn identity(vehicle: &mut Vehicle) -> Result<(protocol::Identity, Option<String>), Failure> {
    let Identity {
        board,
        version,
        chip,
        image,
        table,
    } = vehicle.identity()?;
    let count = Params::TABLE.len();
    let other = (table != table_id())
        .then(|| "Its table of parameters is not this program's: use the sophie of its release".to_owned());
    let identity = protocol::Identity {
        firmware: format!("SOPHIE {version} on {board}"),
        build: format!("build {image:08x}, {count} parameters, table {table:08x}"),
        chip: if chip.is_empty() {
            "unknown".to_owned()
        } else {
            chip
        },
    };
    Ok((identity, other))
}

/// Settings of the chip; not those of the stored data, which the setup repairs.
fn chip_rows(walk: &mut Walk<'_>) -> Result<Result<Vec<Row>, String>, Stop> {
    report(walk, SophieReport::SOPHIE_REPORT_CHIP)
}

pub(super) fn chip(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let mut found = match chip_rows(walk)? {
        Ok(found) => found,
        Err(refused) => return Ok(Verdict::of(false, vec![refused])),
    };
    let level = [ArmingInhibit::BrownOutLevel];
    if let Some(row) = found.iter().find(|row| !row.passed && row.concerns(&level)) {
        for line in [
            &*format!("{}: {}", row.name, row.found),
            "Until it is set, a supply that breaks down lets the chip execute garbage. Setting it writes the",
            "chip's option bytes: from then on the chip stands in reset below that level, with this firmware",
            "and every other, until a tool for option bytes takes it back. Nothing else is changed.",
        ] {
            walk.say(&format!("  | {line}"));
        }
        walk.ask("Enter sets it, once for this chip, s skips, q stops:")?;
        if let Err(Failure::Board(line)) = walk.vehicle.restarting(MavCmd::MAV_CMD_SOPHIE_SET_BROWN_OUT) {
            return Ok(Verdict::of(false, vec![line]));
        }
        walk.ready()?;
        found = match chip_rows(walk)? {
            Ok(found) => found,
            Err(refused) => return Ok(Verdict::of(false, vec![refused])),
        };
    }
    if found.is_empty() {
        let none = "the board reports no settings of its chip".to_owned();
        return Ok(Verdict::of(false, vec![none]));
    }
    let line = |row: &Row| {
        let mark = if row.passed { "" } else { ", not as expected" };
        format!("{}: {}{mark}", row.name, row.found)
    };
    let sound = found.iter().all(|row| row.passed || row.concerns(&UNSOUND));
    Ok(Verdict::of(sound, found.iter().map(line).collect()))
}

pub(super) fn setup(walk: &mut Walk<'_>, _: &Step) -> Judged {
    for name in SETUP {
        set_up(walk, name)?;
        if name == "motor_protocol" && takes_pulses(walk)? {
            for name in PULSES {
                set_up(walk, name)?;
            }
        }
    }
    walk.ready()?;
    let failing = walk.vehicle.arming()?;
    if let Some(why) = failing.iter().find(|why| UNSOUND.contains(why)) {
        walk.say(&format!("  | {}", why.text()));
        walk.ask("Enter erases what cannot be read and stores these, s skips, q stops:")?;
        walk.restart()?;
    }
    let kept = walk.keep()?;
    let pulses = takes_pulses(walk)?;
    let values = walk.vehicle.values()?;
    let asked = |name: &str| SETUP.contains(&name) || pulses && PULSES.contains(&name);
    let rows = Params::TABLE.iter().filter(|row| asked(row.name));
    let figures = rows.filter_map(|row| Some(format!("{} {}", row.name, values.get(row.name)?)));
    let mut verdict = Verdict::of(true, figures.collect());
    verdict.parameters = kept;
    Ok(verdict)
}

/// True if the motor controllers take pulses, by the parameters.
fn takes_pulses(walk: &mut Walk<'_>) -> Result<bool, Stop> {
    Ok(by_pulses(&walk.vehicle.values()?.params()))
}

/// Shows a parameter and takes another value for it.
fn set_up(walk: &mut Walk<'_>, name: &str) -> Result<(), Stop> {
    let Some(row) = Params::row(name) else {
        return Ok(());
    };
    let now = walk.vehicle.value(name)?;
    walk.say(&format!(
        "  | {name} {}{}; it takes {}",
        Shown(row, now),
        Unit(row.unit),
        Allowed(row)
    ));
    loop {
        let reply = walk.ask(&format!("Enter keeps {name}, or type another value:"))?;
        if reply.is_empty() {
            return Ok(());
        }
        let named = row.choice_named(&reply).map(|choice| choice.value);
        let Some(value) = named.or_else(|| decimal::parse(&reply)) else {
            walk.say(&format!(
                "  | '{reply}' is no value; {name} takes {}",
                Allowed(row)
            ));
            continue;
        };
        match walk.set(name, value)? {
            Ok(_) => return Ok(()),
            Err(refused) => walk.say(&format!("  | {refused}")),
        }
    }
}

/// The rows of the self-test.
fn tested(walk: &mut Walk<'_>) -> Result<Result<Vec<Row>, String>, Stop> {
    walk.ready()?;
    report(walk, SophieReport::SOPHIE_REPORT_SELF_TEST)
}

pub(super) fn selftest(walk: &mut Walk<'_>, _: &Step) -> Judged {
    Ok(match tested(walk)? {
        Ok(rows) => {
            let passed = rows.iter().all(|row| row.passed || row.concerns(&STILL_OFF));
            Verdict::of(passed && !rows.is_empty(), rows.iter().map(Row::line).collect())
        }
        Err(refused) => Verdict::of(false, vec![refused]),
    })
}

pub(super) fn everything(walk: &mut Walk<'_>, _: &Step) -> Judged {
    // A value that was set in a step without a verdict is in force from now on.
    let kept = walk.keep()?;
    let rows = match tested(walk)? {
        Ok(rows) => rows,
        Err(refused) => return Ok(Verdict::of(false, vec![refused])),
    };
    let sound = !rows.is_empty() && rows.iter().all(|row| row.passed);
    let mut figures: Vec<String> = rows.iter().map(Row::line).collect();
    walk.ready()?;
    let failing = walk.vehicle.arming()?;
    figures.extend(
        failing
            .iter()
            .map(|why| format!("arming refused: {}", why.text())),
    );
    if failing.is_empty() {
        figures.push("nothing forbids arming".to_owned());
    }
    let values = walk.vehicle.values()?;
    for row in Params::TABLE {
        let value = values.get(row.name).unwrap_or(row.default);
        if value.to_bits() != row.default.to_bits() {
            figures.push(format!("not the default: {} {}", row.name, number(value)));
        }
    }
    let mut verdict = Verdict::of(sound && failing.is_empty(), figures);
    verdict.parameters = kept;
    Ok(verdict)
}
