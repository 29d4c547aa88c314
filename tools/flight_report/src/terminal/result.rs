//! Output before and after a flight.

use sophie_sim::record::FlightRecord;
use sophie_sim::scenario::{Scenario, keys};
use sophie_terminal::console::Console;

use sophie_charts::units::{deg, kgcm, tidy};
use sophie_terminal::table::{Align, Table};

/// One line on the flight to come.
pub fn intro(scenario: &Scenario) -> String {
    format!(
        "{}: configuration {}, infill {} %, K {}, {} mixer, arms {}, seed {}",
        scenario.name,
        keys::configuration_word(scenario.vehicle.configuration),
        scenario.vehicle.infill,
        scenario.vehicle.gain_k,
        keys::mixer_word(scenario.mixer),
        keys::arms_word(scenario.arms),
        scenario.seed
    )
}

/// The phase table and the grip table.
pub fn tables(record: &FlightRecord) -> Vec<String> {
    let mut lines = vec![String::new()];
    lines.extend(phases(record).lines());
    if !record.grip.is_empty() {
        lines.push(String::new());
        lines.extend(grip(record).lines());
    }
    if !record.strikes.is_empty() {
        lines.push(String::new());
        lines.extend(strikes(record).lines());
    }
    lines.extend(differences(&record.scenario));
    lines
}

/// What the stack's parameters have wrong, after an empty line; no lines where nothing is.
pub fn differences(scenario: &Scenario) -> Vec<String> {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("not as the parameters have it", Left),
        ("true", Right),
        ("assumed", Right),
        ("off by", Right),
    ]);
    let differences = scenario.differences();
    if differences.is_empty() {
        return Vec::new();
    }
    for difference in &differences {
        table.row([
            difference.key.clone(),
            format!("{:.4}", tidy(difference.truth)),
            format!("{:.4}", tidy(difference.assumed)),
            difference
                .percent()
                .map_or_else(String::new, |p| format!("{p:+.1} %")),
        ]);
    }
    let mut lines = vec![String::new()];
    lines.extend(table.lines());
    lines
}

fn phases(record: &FlightRecord) -> Table {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("step", Left),
        ("duration s", Right),
        ("attitude error deg", Right),
        ("worst α deg", Right),
        ("saturated %", Right),
        ("battery V", Right),
        ("overruns", Right),
        ("status", Left),
    ]);
    for p in &record.phases {
        table.row([
            p.name.clone(),
            format!("{:.1}", p.end - p.start),
            format!("{:.1}", deg(p.worst_attitude_error)),
            format!("{:+.1}", deg(p.worst_tilt)),
            format!("{:.1}", 100.0 * p.saturation),
            format!("{:.2}", p.battery_voltage),
            p.overruns.to_string(),
            if p.done {
                "done".to_owned()
            } else {
                "not done".to_owned()
            },
        ]);
    }
    table
}

fn grip(record: &FlightRecord) -> Table {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("grip", Left),
        ("pressure N/m²", Right),
        ("true N/m²", Right),
        ("force kgcm", Right),
        ("closure s", Right),
    ]);
    for g in &record.grip {
        table.row([
            format!("arm {}", g.arm),
            format!("{:.0}", g.pressure),
            format!("{:.0}", g.pressure_true),
            format!("{:.2}", kgcm(g.torque)),
            format!("{:.2}", g.closure),
        ]);
    }
    table
}

fn strikes(record: &FlightRecord) -> Table {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("propeller strike", Left),
        ("against", Left),
        ("at s", Right),
        ("for s", Right),
        ("depth mm", Right),
    ]);
    for s in &record.strikes {
        table.row([
            format!("arm {}", s.arm),
            s.against.name().to_owned(),
            format!("{:.2}", s.start),
            format!("{:.2}", s.end - s.start),
            format!("{:.0}", 1e3 * s.depth),
        ]);
    }
    table
}

/// What each rule of the judge found, a line.
pub fn judged(record: &FlightRecord) -> String {
    let found = record.verdicts.iter().map(|verdict| {
        let rule = verdict.rule.word();
        verdict
            .fault
            .as_ref()
            .map_or(format!("{rule}: no fault"), |fault| format!("{rule}: {fault}"))
    });
    format!("judged: {}", found.collect::<Vec<_>>().join(" | "))
}

/// Result of the flight in one line.
pub fn verdict(console: &Console, record: &FlightRecord) -> String {
    let word = if record.outcome.accomplished {
        "accomplished"
    } else {
        "NOT accomplished"
    };
    let speed = record.sim_seconds / record.wall_seconds.max(1e-6);
    let decimals = if speed < 10.0 { 2 } else { 0 };
    format!(
        "{}: {:.1} s flown in {:.2} s ({speed:.decimals$} times real time), {} overruns",
        console.paint(word, record.outcome.accomplished),
        record.sim_seconds,
        record.wall_seconds,
        record.overruns
    )
}
