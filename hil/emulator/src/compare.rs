//! Compares one flight on the host and on the emulated chip, phase by phase.
//!
//! The attitude error is against the controller's target on the host, against the sticks on the chip, which does not
//! report a target. The chip's pins act a millisecond later, and its self-test shifts pilot against gusts.

use serde_json::{Value, json};
use sophie_charts::units::{deg, kgcm};
use sophie_sim::record::{FlightRecord, Grip, Phase};
use sophie_terminal::table::{Align, Table};

fn outcome(record: &FlightRecord) -> &'static str {
    if record.outcome.accomplished {
        "accomplished"
    } else {
        "not accomplished"
    }
}

/// The same outcome by the same steps, done or not.
#[must_use]
pub fn alike(host: &FlightRecord, chip: &FlightRecord) -> bool {
    let steps = |record: &FlightRecord| -> Vec<(String, bool)> {
        let phases = record.phases.iter();
        phases.map(|p| (p.name.clone(), p.done)).collect()
    };
    host.outcome.accomplished == chip.outcome.accomplished && steps(host) == steps(chip)
}

/// Each line on the host, then on the chip.
#[must_use]
pub fn lines(host: &FlightRecord, chip: &FlightRecord) -> Vec<String> {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("the same on host / chip", Left),
        ("duration s", Right),
        ("attitude error deg", Right),
        ("worst α deg", Right),
        ("overruns", Right),
        ("", Left),
    ]);
    let both = |of: &dyn Fn(&Phase) -> String, pair: [Option<&Phase>; 2]| {
        pair.map(|p| p.map_or("–".to_owned(), of)).join(" / ")
    };
    for nth in 0..host.phases.len().max(chip.phases.len()) {
        let pair = [host, chip].map(|record| record.phases.get(nth));
        let Some(name) = pair.iter().flatten().map(|p| p.name.clone()).next() else {
            continue;
        };
        table.row([
            name,
            both(&|p| format!("{:.1}", p.end - p.start), pair),
            both(&|p| format!("{:.1}", deg(p.worst_attitude_error)), pair),
            both(&|p| format!("{:+.1}", deg(p.worst_tilt)), pair),
            both(&|p| p.overruns.to_string(), pair),
            both(&|p| if p.done { "done" } else { "not done" }.to_owned(), pair),
        ]);
    }
    table.row([
        "mission".to_owned(),
        format!("{:.1} / {:.1}", host.sim_seconds, chip.sim_seconds),
        String::new(),
        String::new(),
        format!("{} / {}", host.overruns, chip.overruns),
        format!("{} / {}", outcome(host), outcome(chip)),
    ]);
    let mut lines = table.lines();
    if !(host.grip.is_empty() && chip.grip.is_empty()) {
        lines.push(String::new());
        lines.extend(grips(host, chip).lines());
    }
    lines
}

fn grips(host: &FlightRecord, chip: &FlightRecord) -> Table {
    use Align::{Left, Right};
    let mut table = Table::new(&[
        ("grip on host / chip", Left),
        ("pressure N/m²", Right),
        ("true N/m²", Right),
        ("force kgcm", Right),
        ("closure s", Right),
    ]);
    for arm in 1..=4 {
        let pair = [host, chip].map(|record| record.grip.iter().find(|g| g.arm == arm));
        if pair == [None, None] {
            continue;
        }
        let both = |of: &dyn Fn(&Grip) -> String| pair.map(|g| g.map_or("–".to_owned(), of)).join(" / ");
        table.row([
            format!("arm {arm}"),
            both(&|g| format!("{:.0}", g.pressure)),
            both(&|g| format!("{:.0}", g.pressure_true)),
            both(&|g| format!("{:.2}", kgcm(g.torque))),
            both(&|g| format!("{:.2}", g.closure)),
        ]);
    }
    table
}

/// As JSON; the chip's is beside it.
#[must_use]
pub fn value(host: &FlightRecord) -> Value {
    json!({
        "accomplished": host.outcome.accomplished,
        "reason": host.outcome.reason,
        "sim_seconds": host.sim_seconds,
        "overruns": host.overruns,
        "phases": host.phases.iter().map(|p| json!({
            "name": p.name,
            "start_s": p.start,
            "end_s": p.end,
            "done": p.done,
            "worst_attitude_error_deg": deg(p.worst_attitude_error),
            "worst_tilt_deg": deg(p.worst_tilt),
        })).collect::<Vec<_>>(),
        "grip": host.grip.iter().map(|g| json!({
            "arm": g.arm,
            "pressure_pa": g.pressure,
            "pressure_true_pa": g.pressure_true,
            "force_kgcm": kgcm(g.torque),
            "closure_s": g.closure,
        })).collect::<Vec<_>>(),
    })
}

#[cfg(test)]
mod tests {
    use sophie_sim::flight::fly;
    use sophie_sim::record::Silent;
    use sophie_sim::scenario::{Overrides, Scenario};

    use super::*;

    #[test]
    fn a_value_missing_from_one_flight_prints_as_a_dash() {
        let text = "steps = [{ do = 'arm' }, { do = 'take-off', height_m = 1 }]\n";
        let scenario = Scenario::parse(text, "hop.toml", &Overrides::default()).unwrap();
        let host = fly(&scenario, &mut Silent);
        let mut chip = host.clone();
        assert!(alike(&host, &chip));
        chip.phases[1].done ^= true;
        assert!(!alike(&host, &chip), "a step that was not done");
        chip.phases.pop();
        assert!(!alike(&host, &chip), "a step less");
        chip.outcome.accomplished = false;
        let text = lines(&host, &chip).join("\n");
        assert!(
            text.contains(" / –") && text.contains("accomplished / not accomplished"),
            "{text}"
        );
        assert!(!text.contains("grip"), "{text}");
        assert_eq!(value(&host)["phases"].as_array().unwrap().len(), 2);
    }
}
