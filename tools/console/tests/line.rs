//! A port that goes with its board at a restart and comes back, as one on USB does.

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Duration;

use sophie_console::port::PortName;
use sophie_console::session::Session;

/// Answers as the console does until `restart` is typed; then the line is gone.
fn console(mut line: TcpStream) {
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
                let answer = format!("\r\nno command '{typed}'; try 'help'\r\n> ");
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
        console(listener.accept().unwrap().0);
        // Gone for a while: nothing can be opened.
        drop(listener);
        thread::sleep(Duration::from_millis(300));
        let again = TcpListener::bind(address).unwrap();
        console(again.accept().unwrap().0);
    });
    let port: PortName = format!("tcp:{address}").parse().unwrap();
    let stop = Arc::new(AtomicBool::new(false));
    let mut session = Session::open(&port, None, Duration::from_secs(5), stop).unwrap();
    let said = session.restart("restart").unwrap();
    assert_eq!(said.last().map(String::as_str), Some("restarting"));
    assert_eq!(session.restarts(), 1);
    let answer = session.command("hello").unwrap();
    assert_eq!(answer, ["no command 'hello'; try 'help'"]);
    drop(session);
    board.join().unwrap();
}
