//! A line that goes with its board at a restart and comes back, as one on USB does, and one that loses an answer.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

use sophie_board_link::parameters::{Version, version};
use sophie_board_link::port::PortName;
use sophie_board_link::session::Session;
use sophie_tasks::console::NOT_TEXT;

fn unknown(typed: &str) -> String {
    format!("no command '{typed}'; try 'help'\r\n")
}

/// Answers as the console does until `restart` is typed; then the line is gone.
fn console(mut line: TcpStream, mut answer: impl FnMut(&str) -> String) {
    let mut text = String::new();
    let mut byte = [0];
    while line.read(&mut byte).is_ok_and(|count| count > 0) {
        match byte[0] {
            b'\r' => {
                let typed = std::mem::take(&mut text);
                if typed == "restart" {
                    line.write_all(b"\r\nrestarting\r\n").unwrap();
                    return;
                }
                let answer = format!("\r\n{}> ", answer(&typed));
                line.write_all(answer.as_bytes()).unwrap();
            }
            0x03 | 0x80 => text.clear(),
            byte => {
                text.push(char::from(byte));
                line.write_all(&[byte]).unwrap();
            }
        }
    }
}

#[test]
fn a_session_outlives_a_restart_that_takes_its_port_away() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let board = thread::spawn(move || {
        console(listener.accept().unwrap().0, unknown);
        // Gone for a while: nothing can be opened.
        drop(listener);
        thread::sleep(Duration::from_millis(300));
        let again = TcpListener::bind(address).unwrap();
        console(again.accept().unwrap().0, unknown);
    });
    let port: PortName = format!("tcp:{address}").parse().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let mut session = Session::open(&port, None, Duration::from_secs(5), stop).unwrap();
    let said = session.restart("restart").unwrap();
    assert_eq!(said.last().map(String::as_str), Some("restarting"));
    let answer = session.command("hello").unwrap();
    assert_eq!(answer, ["no command 'hello'; try 'help'"]);
    drop(session);
    board.join().unwrap();
}

#[test]
fn a_command_keeps_to_the_console_s_rule_before_it_is_typed() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port: PortName = format!("tcp:{}", listener.local_addr().unwrap()).parse().unwrap();
    let board = thread::spawn(move || {
        let mut typed = Vec::new();
        console(listener.accept().unwrap().0, |text| {
            if text.is_empty() {
                return String::new();
            }
            typed.push(text.to_owned());
            unknown(text)
        });
        typed
    });
    let mut session = Session::open(&port, None, Duration::from_secs(5), Arc::default()).unwrap();
    for pasted in [
        "set infill 7\0.5",
        "set infill 4\x1b[C.5",
        "set infill 1\r0",
        "set infill 10\u{a0}%",
    ] {
        assert_eq!(session.command(pasted), Ok(vec![NOT_TEXT.to_owned()]));
    }
    let answer = unknown("set infill 10").trim_end().to_owned();
    assert_eq!(session.command("set infill\t10"), Ok(vec![answer]));
    drop(session);
    let typed = board.join().unwrap();
    let sets: Vec<_> = typed.iter().filter(|line| line.starts_with("set")).collect();
    assert_eq!(sets, ["set infill 10"]);
}

#[test]
fn a_version_whose_lines_are_lost_is_asked_for_again() {
    const FIRMWARE: &str = "SOPHIE 0.1.0 on table\r\n";
    const BUILD: &str = "build 1234abcd, parameters 5678\r\n";
    for (answers, build, asked) in [
        (&[String::new(), format!("{FIRMWARE}{BUILD}")][..], BUILD, 2),
        (&[FIRMWARE.to_owned(), BUILD.to_owned()], BUILD, 2),
        // An earlier firmware has no build: the retry ends.
        (&[FIRMWARE.to_owned()], "build unknown", 3),
    ] {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port: PortName = format!("tcp:{}", listener.local_addr().unwrap()).parse().unwrap();
        let (typed, times) = channel();
        let answers = answers.to_vec();
        let board = thread::spawn(move || {
            let mut nth = 0;
            console(listener.accept().unwrap().0, |text| match text {
                "version" => {
                    let answer = answers[nth.min(answers.len() - 1)].clone();
                    nth += 1;
                    typed.send(()).unwrap();
                    answer
                }
                "" => String::new(),
                other => unknown(other),
            });
        });
        let mut session = Session::open(&port, None, Duration::from_secs(5), Arc::default()).unwrap();
        let wanted = Version {
            firmware: FIRMWARE.trim_end().to_owned(),
            build: build.trim_end().to_owned(),
        };
        assert_eq!(version(&mut session), Ok(wanted), "{asked}");
        drop(session);
        board.join().unwrap();
        assert_eq!(times.iter().count(), asked);
    }
}
