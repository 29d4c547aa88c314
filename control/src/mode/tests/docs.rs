//! `docs/modes.md` is printed from the code.

extern crate std;
use std::fmt::Write;
use std::string::{String, ToString};
use std::vec::Vec;

use crate::arming::ArmingInhibit;
use crate::mode::table::transitions::{Notice, Origin, TRANSITIONS, Transition};
use crate::mode::*;

fn names(from: Origin) -> String {
    match from {
        Origin::In(modes) => modes.iter().map(|m| m.name()).collect::<Vec<_>>().join(", "),
        Origin::RotorsTurning => "any with rotors turning".to_string(),
    }
}

fn notice(row: &Transition) -> String {
    match row.notice {
        Notice::Keep => String::new(),
        Notice::Clear => "(cleared)".to_string(),
        Notice::Show(reason) => reason.text().to_string(),
        Notice::ShowOf(_) => "(the cause)".to_string(),
        Notice::LastingOf(_) => "(the cause), as long as it lasts".to_string(),
        Notice::Lasting(reason) => std::format!("{}, as long as it lasts", reason.text()),
    }
}

fn transitions() -> String {
    let mut text = String::from("| | in | when | to | the pilot reads |\n|---|---|---|---|---|\n");
    for (i, row) in TRANSITIONS.iter().enumerate() {
        let when: Vec<_> = row.when.iter().map(|guard| guard.name).collect();
        let (from, to) = (names(row.from), row.to.mode().name());
        writeln!(
            text,
            "| {} | {from} | {} | {to} | {} |",
            i + 1,
            when.join("; "),
            notice(row)
        )
        .unwrap();
    }
    text
}

fn checks() -> String {
    let mut text = String::from("| check | the pilot reads | cleared by |\n|---|---|---|\n");
    for check in ArmingInhibit::ALL {
        writeln!(
            text,
            "| `{check:?}` | {} | {} |",
            check.text(),
            check.cleared_by()
        )
        .unwrap();
    }
    text
}

fn reasons() -> String {
    let list = Reason::PLAIN.iter().map(|r| std::format!("`{}`", r.text()));
    list.collect::<Vec<_>>().join(", ") + ".\n"
}

#[test]
fn the_page_of_the_modes_is_what_the_code_prints() {
    let parts = [
        ("transitions", transitions()),
        ("reasons", reasons()),
        ("checks", checks()),
    ];
    sophie_pages::hold("modes", &parts, "--package sophie-control mode::tests::docs");
}
