//! Types the commands of the first-hour page at the emulated board's console and compares the answers.

use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream};

use sophie_emulator::closed_loop::Setup;
use sophie_emulator::terminal::Sockets;
use sophie_emulator::wires::BoardFault;
use sophie_test_support::signals::uninterrupted;

use super::console::{terminal, wake};
use super::script::{Typed, differs, typed};
use super::*;

const PAGE: &str = "docs/first-hour.md";
/// s: until after the page's last `save`.
const RADIO_OFF: f64 = 28.0;
const PROMPT: &str = "\r\n> ";
/// Repetitions of `status`, some 25 ms each.
const TRIES: usize = 1000;

#[test]
fn the_commands_of_the_page_have_the_answers_of_the_page_and_lead_to_the_first_hover() {
    let page = std::fs::read_to_string(root().join(PAGE)).unwrap();
    let script = typed(&page);
    let (port, console) = terminal("--console");
    let user = std::thread::spawn(move || {
        let mut user = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
        wake(&mut user);
        for step in &script {
            type_in(&mut user, step);
        }
        script.len()
    });
    let firmware = Firmware::read(image(), board_kind::find("matek-h743").unwrap()).unwrap();
    // A new board: no level set, nothing stored but the bench's level calibration.
    let mut scenario = unmarked(hop());
    scenario.steps.insert(0, Step::RadioOff { seconds: RADIO_OFF });
    let plan = Plan::new([(0, Trouble::Board(BoardFault::FactoryOptions))]);
    let setup = Setup {
        speed: 1.0,
        plan,
        sockets: Sockets {
            console: Some(console),
            ..Sockets::default()
        },
    };
    let flight = flight::fly(&firmware, &scenario, setup, |_| (), &mut Silent).unwrap();
    let steps = user.join().unwrap_or_else(|_| panic!("{}", log(&flight)));
    assert!(steps >= 10, "{PAGE} has {steps} commands");
    assert!(flight.passed(), "{:?}\n{}", flight.record.outcome, log(&flight));
}

/// Types a command and compares the answer; repeats one that takes time.
fn type_in(user: &mut TcpStream, step: &Typed) {
    let mut last = String::new();
    let restarts = step.restarts();
    let tries = if step.command == "status" { TRIES } else { 1 };
    for _ in 0..tries {
        last = heard(user, step);
        if differs(step, &last).is_none() {
            if restarts {
                wake(user);
            }
            return;
        }
    }
    panic!(
        "{PAGE}:{}: {}",
        step.line,
        differs(step, &last).unwrap_or_default()
    );
}

/// Types the command and its keys; returns the output until prompt or restart.
fn heard(user: &mut TcpStream, step: &Typed) -> String {
    user.write_all(format!("{}\r", step.command).as_bytes()).unwrap();
    let mut said = String::new();
    // Prompts of earlier commands come first.
    let Some(mut from) = until(user, &mut said, 0, &step.command) else {
        return said;
    };
    for after in step.keys() {
        match until(user, &mut said, from, after) {
            Some(there) => from = there,
            None => return said,
        }
        user.write_all(b" ").unwrap();
    }
    let end = if step.restarts() { "restarting\r\n" } else { PROMPT };
    until(user, &mut said, from, end);
    said
}

/// End of `text` after the first `from` bytes; `None` if a prompt comes first.
fn until(user: &mut TcpStream, said: &mut String, from: usize, text: &str) -> Option<usize> {
    let mut bytes = [0; 64];
    loop {
        let news = said.get(from..).unwrap_or_default();
        if let Some(at) = news.find(text) {
            return Some(from + at + text.len());
        }
        if from > 0 && news.ends_with(PROMPT) {
            return None;
        }
        let count = uninterrupted(|| user.read(&mut bytes)).unwrap();
        assert!(count > 0, "the board has gone: {said}");
        said.push_str(&String::from_utf8_lossy(&bytes[..count]));
    }
}

#[test]
fn every_prompt_of_the_page_is_typed() {
    let page = std::fs::read_to_string(root().join(PAGE)).unwrap();
    let prompts = page.lines().filter(|line| line.trim().starts_with("> ")).count();
    assert_eq!(
        typed(&page).len(),
        prompts,
        "{PAGE}: a prompt stands outside a block marked console"
    );
}
