//! Both rules of the judge on whole flights.

use sophie_sim::flight::fly;
use sophie_sim::record::{FlightRecord, Silent};
use sophie_sim::scenario::{Overrides, Rule, Scenario};

/// The default mission to the hold, with half an hour on the pipe, changed by `lines`.
fn flight(lines: &str) -> FlightRecord {
    let text = format!(
        "judge = 'holding'\nsteps = [{{ do = 'arm' }}, {{ do = 'take-off' }}, {{ do = 'fly-to-pipe' }}, {{ do = 'touch' }}, \
         {{ do = 'perch' }}, {{ do = 'hold', seconds = 6, lapse_min = 30 }}]\n{lines}"
    );
    fly(
        &Scenario::parse(&text, "judge.toml", &Overrides::default()).unwrap(),
        &mut Silent,
    )
}

fn fault(record: &FlightRecord, rule: Rule) -> Option<&str> {
    let mut verdicts = record.verdicts.iter();
    verdicts.find(|v| v.rule == rule)?.fault.as_deref()
}

#[test]
fn a_sound_grip_passes_both_rules_at_its_proof_and_after_half_an_hour() {
    let record = flight("");
    assert!(record.outcome.accomplished, "{}", record.outcome.reason);
    for rule in [Rule::Paper, Rule::Holding] {
        assert_eq!(fault(&record, rule), None);
    }
    // Six seconds and the minute in which half an hour passes.
    let hold = record.phases.iter().find(|phase| phase.name == "hold").unwrap();
    assert!((hold.end - hold.start - 66.0).abs() < 0.1, "{hold:?}");
}

#[test]
fn sensors_that_read_wrong_fail_the_paper_and_hold_all_the_same() {
    let record = flight("[faults]\npressure_gain = [1.2, 0.8, 0.85, 1.15]");
    assert!(record.outcome.accomplished, "{}", record.outcome.reason);
    let paper = fault(&record, Rule::Paper).expect("a fault by the paper");
    assert!(paper.contains("N/m2, wanted 950 within"), "{paper}");
}

/// A greasy pipe, unknown to the stack: the pressures are right, the grip is not.
#[test]
fn a_grip_that_a_push_moves_does_not_hold() {
    let record = flight("[world]\npipe_friction = 0.12\n[params]\npipe_friction = 0.6");
    let holding = fault(&record, Rule::Holding).expect("a fault by the rule of holding");
    assert!(!record.outcome.accomplished);
    println!("{holding}");
    assert!(
        holding.contains("does not hold") || holding.contains("slipped"),
        "{holding}"
    );
}
