//! MAVLink clients at the emulated boards' line.

use sophie_test_support::clients;
use std::io::{Read, Write};
use std::net::{Ipv4Addr, TcpStream};

use serde_json::Value;
use sophie_control::params::Params;
use sophie_emulator::closed_loop::Setup;
use sophie_emulator::terminal::{Sockets, Terminal};

use super::console::terminal;
use super::*;

/// Longest wait of a client, s: the board runs at half of real time, on a machine that is busy.
const SECONDS: &str = "300";
/// Capacity of the line, bytes per second: 57,600 baud, ten bits a byte.
const LINE_RATE: f64 = 5760.0;
/// Most by which a flood may make the mean time from data-ready to the motor frame longer, us.
const MEAN_MOVED: f64 = 0.05;
/// The same of its worst.
const WORST_MOVED: f64 = 0.2;

/// A flight with `client` on the MAVLink line.
fn fly_with_client(
    firmware: &Firmware,
    scenario: &Scenario,
    radio: bool,
    client: Option<Terminal>,
) -> Flight {
    let silent = (!radio).then_some((0, Trouble::RadioSilent(true)));
    let setup = Setup {
        speed: 1.0,
        plan: Plan::new(silent),
        sockets: Sockets {
            mavlink: client,
            ..Sockets::default()
        },
    };
    flight::fly(firmware, scenario, setup, |_| (), &mut Silent).unwrap()
}

/// A sound heartbeat of a station, and a request for the parameters of system 2.
const HEARTBEAT: [u8; 21] = [
    0xFD, 9, 0, 0, 0, 255, 190, 0, 0, 0, 0, 0, 0, 0, 6, 8, 0, 0, 3, 0x5C, 0x2B,
];
const FOR_ANOTHER: [u8; 14] = [0xFD, 2, 0, 0, 0, 255, 190, 0x15, 0, 0, 2, 1, 0xEC, 0x2F];

/// Sends as fast as the socket takes it, and reads what comes, until the board has gone: garbage, the start of frames
/// of every length, frames with a wrong checksum, cut short, for another vehicle, and one again and again.
fn flood(port: u16) {
    let mut client = TcpStream::connect((Ipv4Addr::LOCALHOST, port)).unwrap();
    let mut reader = client.try_clone().unwrap();
    std::thread::spawn(move || while matches!(reader.read(&mut [0; 256]), Ok(count) if count > 0) {});
    let mut state = 1_u32;
    let mut bytes = Vec::new();
    for length in 0..=u8::MAX {
        bytes.extend(HEARTBEAT);
        bytes.extend(FOR_ANOTHER);
        bytes.extend(HEARTBEAT.split_last().unwrap().1);
        bytes.extend([0xFD, length, 0, 0, length, 255, 190, 0, 0, 0]);
        for _ in 0..=length {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            bytes.push((state >> 24) as u8);
        }
    }
    while client.write_all(&bytes).is_ok() {}
}

/// Flies a hop on `board` without and with a flood on the MAVLink line.
fn a_flood_moves_nothing(board: &str, image: &Path) {
    let firmware = Firmware::read(image, board_kind::find(board).unwrap()).unwrap();
    let quiet = fly_with_client(&firmware, &hop(), true, None);
    let (port, client) = terminal("--mavlink");
    let client_thread = std::thread::spawn(move || flood(port));
    let flooded = fly_with_client(&firmware, &hop(), true, Some(client));
    client_thread.join().unwrap();
    for flight in [&quiet, &flooded] {
        assert!(
            flight.passed(),
            "{board}: {:?} {:?}\n{}",
            flight.record.outcome,
            flight.gaps,
            log(flight)
        );
        for task in FLIGHT_LEVEL {
            assert_eq!(
                flight.board.overruns.get(task).copied().unwrap_or(0),
                0,
                "{board}: {task}"
            );
        }
    }
    let carried = flooded.board.mavlink_received as f64 / flooded.record.sim_seconds;
    assert!(carried > 0.9 * LINE_RATE, "{board}: {carried} bytes each second");
    let [before, after] = [&quiet, &flooded].map(|flight| flight.board.run.latency_us);
    println!(
        "{board}: {carried:.0} bytes/s; mean {:.2} to {:.2} us, worst {:.2} to {:.2} us",
        before.mean(),
        after.mean(),
        before.worst,
        after.worst
    );
    assert!(
        after.mean() - before.mean() < MEAN_MOVED && after.worst - before.worst < WORST_MOVED,
        "{board}: {before:?} {after:?}"
    );
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn a_flood_at_line_rate_moves_no_deadline_figure_of_the_small_board() {
    a_flood_moves_nothing("f405", small_image());
}

#[test]
#[ignore = "minutes of emulated flight: .ci/campaign flies it"]
fn nor_of_the_reference_board() {
    a_flood_moves_nothing("matek-h743", image());
}

/// Runs a reference board on the ground without a transmitter until `client` at its MAVLink line ends; returns the
/// client's output.
fn stand_with(client: impl FnOnce(u16) -> Value + Send + 'static) -> Value {
    clients::python();
    let firmware = Firmware::read(image(), board_kind::find("matek-h743").unwrap()).unwrap();
    let (port, line) = terminal("--mavlink");
    let client = std::thread::spawn(move || client(port));
    let setup = Setup {
        speed: 1.0,
        plan: Plan::new([]),
        sockets: Sockets {
            mavlink: Some(line),
            ..Sockets::default()
        },
    };
    let mut log = String::new();
    let stood = flight::stand(
        &firmware,
        &scenario("hover.toml"),
        setup,
        None,
        |line| log += &format!("{line}\n"),
        || client.is_finished(),
    )
    .unwrap();
    let said = client.join().unwrap_or_else(|why| {
        // What the client missed stands last, below the board's log.
        println!("{log}");
        panic!(
            "{}",
            why.downcast_ref::<String>().map_or("client", String::as_str)
        )
    });
    assert_eq!(stood.gaps, []);
    for task in FLIGHT_LEVEL {
        let missed = stood.board.overruns.get(task).copied().unwrap_or(0);
        assert_eq!(missed, 0, "{task}\n{log}");
    }
    said
}

/// Every parameter of the table, by name, `infill` as it was set.
fn holds_all(params: &Value, infill: f64) {
    let read = params.as_object().unwrap();
    assert_eq!(read.len(), Params::TABLE.len(), "{params}");
    for row in Params::TABLE {
        assert!(read.contains_key(row.name), "{}: {params}", row.name);
    }
    let set = read["infill"].as_f64().unwrap();
    assert!((set - infill).abs() < 1e-6, "{params}");
}

fn said(heard: &Value, text: &str) -> bool {
    let texts = heard["texts"].as_array().unwrap();
    texts.iter().any(|said| said == text)
}

#[test]
#[ignore = "wants pymavlink, which .ci/mavlink-clients installs: .ci/run runs it"]
fn pymavlink_hears_sets_restarts_and_reads_the_reference_board() {
    let tcp = |port: u16| format!("tcp:127.0.0.1:{port}");
    let read = stand_with(move |port| {
        let heard = clients::listen(&tcp(port), 3, &["HEARTBEAT", "ATTITUDE"]);
        assert_eq!((&heard["bad"], &heard["lost"]), (&0.into(), &0.into()), "{heard}");
        for beat in heard["messages"]["HEARTBEAT"].as_array().unwrap() {
            // MAV_TYPE_QUADROTOR, MAV_AUTOPILOT_GENERIC; not armed.
            assert_eq!(
                (&beat["type"], &beat["autopilot"], &beat["system"]),
                (&2.into(), &0.into(), &1.into()),
                "{beat}"
            );
            assert_eq!(beat["base_mode"].as_u64().unwrap() >> 7, 0, "{beat}");
        }
        clients::run("params.py", &[&tcp(port), SECONDS, "infill", "8"])
    });
    holds_all(&read["before"], Params::DEFAULT.infill.into());
    holds_all(&read["after"], 8.0);
}

#[test]
#[ignore = "wants MAVSDK, which .ci/mavlink-clients installs: .ci/run runs it"]
fn mavsdk_hears_sets_restarts_and_is_refused_by_the_reference_board() {
    let did = stand_with(|port| {
        clients::run(
            "sdk.py",
            &[&format!("tcpout://127.0.0.1:{port}"), SECONDS, "restarts"],
        )
    });
    holds_all(&did["params"], Params::DEFAULT.infill.into());
    assert_eq!(
        (&did["set"], &did["restart"]),
        (&"SUCCESS".into(), &"SUCCESS".into()),
        "{did}"
    );
    holds_all(&did["after"], 8.0);
    assert!(did["beyond"] != "SUCCESS", "{did}");
    for angle in did["attitude"].as_array().unwrap() {
        assert!(angle.as_f64().unwrap().abs() < 5.0, "{did}");
    }
    assert!((did["voltage"].as_f64().unwrap() - 16.0).abs() < 1.0, "{did}");
    assert!(did["armed"] == false && did["arm"] == "COMMAND_DENIED", "{did}");
    assert!(did["grab"] != "SUCCESS" && did["release"] != "SUCCESS", "{did}");
    assert!(said(&did, "arming: radio lost"), "{did}");
    // In force after the restart, so that the console has it too.
    assert!(
        did["shell"].as_str().unwrap().contains("infill           8"),
        "{did}"
    );
}

#[test]
#[ignore = "wants MAVProxy, which .ci/mavlink-clients installs: .ci/run runs it"]
fn mavproxy_loads_restarts_and_saves_the_parameters_of_the_reference_board() {
    let did = stand_with(|port| {
        let master = format!("tcp:127.0.0.1:{port}");
        clients::run("proxy.py", &[&master, SECONDS, "infill", "8", "restart"])
    });
    holds_all(&did["params"], 8.0);
}

#[test]
#[ignore = "minutes of emulated flight, and MAVSDK: .ci/campaign flies it"]
fn mavsdk_arms_where_the_pilots_switch_is_on_and_grabs_in_the_air_alone() {
    clients::python();
    let firmware = Firmware::read(image(), board_kind::find("matek-h743").unwrap()).unwrap();
    let (port, line) = terminal("--mavlink");
    let client = std::thread::spawn(move || {
        clients::run(
            "sdk.py",
            &[&format!("tcpout://127.0.0.1:{port}"), SECONDS, "flies"],
        )
    });
    let flight = fly_with_client(&firmware, &hover(20.0), true, Some(line));
    let did = client.join().unwrap_or_else(|_| panic!("{}", log(&flight)));
    for what in ["arms", "grabs"] {
        let tries = did[what].as_array().unwrap();
        assert!(tries.len() > 1 && tries[0] != "SUCCESS", "{what}: {did}");
        assert_eq!(tries.last().unwrap(), "SUCCESS", "{what}: {did}");
    }
    assert_eq!(did["release"], "SUCCESS", "{did}");
    // In the air.
    assert!(did["armed"] == true && did["disarm"] == "COMMAND_DENIED", "{did}");
    for text in [
        "refused: only in flight or on the pipe",
        "refused: flying: land first",
    ] {
        assert!(said(&did, text), "{text}: {did}");
    }
    assert_eq!(flight.gaps, []);
}
