//! `sophie fly --live` as a user and his MAVLink clients meet it.

use sophie_test_support::clients;
use std::io::Write;
use std::net::{Ipv4Addr, UdpSocket};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Output, Stdio};
use std::time::{Duration, Instant};

use sophie_test_support::command::{Temp, command, text};
use sophie_test_support::signals::uninterrupted;

/// A flight of 21 s.
const HOP: &[u8] =
    b"steps = [{ do = 'arm' }, { do = 'take-off', height_m = 1 }, { do = 'land' }, { do = 'disarm' }]\n";
/// The same, whose time is up in the air.
const TOO_SHORT: &[u8] = b"time_limit_s = 8\nsteps = [{ do = 'arm' }, { do = 'take-off', height_m = 1 }]\n";
/// Longest wait for anything, on a machine that is busy.
const PATIENCE: Duration = Duration::from_secs(60);

/// A ground station's socket, and its address.
fn station() -> (UdpSocket, String) {
    let socket = UdpSocket::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
    socket.set_read_timeout(Some(PATIENCE)).unwrap();
    let address = socket.local_addr().unwrap().to_string();
    (socket, address)
}

/// A live flight, which ends with the test.
struct Flight(Option<Child>);

impl Flight {
    fn begin(temp: &Temp, args: &[&str]) -> Self {
        let mut command = command(&temp.0, &[&["fly", "--live"], args].concat());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        Self(Some(command.spawn().unwrap()))
    }

    fn id(&self) -> u32 {
        self.0.as_ref().unwrap().id()
    }

    /// Ctrl-C.
    fn interrupt(&self) -> ExitStatus {
        Command::new("kill")
            .args(["-INT", &self.id().to_string()])
            .status()
            .unwrap()
    }

    /// What is left of it after Ctrl-C.
    fn end(mut self) -> Output {
        assert!(self.interrupt().success());
        self.0.take().unwrap().wait_with_output().unwrap()
    }
}

impl Drop for Flight {
    fn drop(&mut self) {
        if let Some(mut child) = self.0.take() {
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// Receives datagrams until one satisfies `wanted`.
fn await_datagram(socket: &UdpSocket, wanted: impl Fn(&[u8]) -> bool) -> std::net::SocketAddr {
    let began = Instant::now();
    let mut bytes = [0; 2048];
    while began.elapsed() < PATIENCE {
        let (length, from) = uninterrupted(|| socket.recv_from(&mut bytes)).unwrap();
        let datagram = &bytes[..length];
        assert!(whole(datagram), "{datagram:02x?}");
        if wanted(datagram) {
            return from;
        }
    }
    panic!("nothing of the kind within {PATIENCE:?}");
}

/// Whole frames of MAVLink 2 alone: their start and their lengths.
fn whole(datagram: &[u8]) -> bool {
    let mut rest = datagram;
    while let [0xFD, length, incompatible, ..] = rest {
        let signature = if incompatible & 1 == 1 { 13 } else { 0 };
        let Some(after) = rest.get(12 + usize::from(*length) + signature..) else {
            return false;
        };
        rest = after;
    }
    !datagram.is_empty() && rest.is_empty()
}

/// A heartbeat of an armed vehicle (base_mode, bit 7), or of one that is not.
fn heartbeat(datagram: &[u8], armed: bool) -> bool {
    let heartbeat = datagram.get(7..10) == Some(&[0, 0, 0]);
    heartbeat
        && datagram
            .get(16)
            .is_some_and(|base_mode| (base_mode >> 7 == 1) == armed)
}

fn written(directory: &Path) -> bool {
    ["report.html", "flight.mcap", "summary.json"]
        .iter()
        .all(|name| directory.join("out").join(name).exists())
}

#[test]
fn a_mission_is_flown_reported_and_waited_after_until_ctrl_c() {
    let temp = Temp::new("live");
    let file = temp.file("hop.toml", HOP);
    let (socket, address) = station();
    let flight = Flight::begin(&temp, &[&file, "--speed", "20", "--mavlink", &address]);
    await_datagram(&socket, |datagram| heartbeat(datagram, false));
    await_datagram(&socket, |datagram| heartbeat(datagram, true));
    await_datagram(&socket, |datagram| heartbeat(datagram, false));
    // It waits once the report is there, and still serves.
    let began = Instant::now();
    while !written(&temp.0) {
        assert!(began.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(20));
    }
    await_datagram(&socket, |datagram| heartbeat(datagram, false));
    let output = flight.end();
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", text(&output.stderr));
    assert!(said.contains(&format!(", sending to {address}\n")), "{said}");
    assert!(
        said.contains("accomplished: 2") && said.ends_with("waits until Ctrl-C\n"),
        "{said}"
    );
}

#[test]
fn a_mission_that_failed_waits_as_well_and_ends_with_1() {
    let temp = Temp::new("live-failed");
    let file = temp.file("short.toml", TOO_SHORT);
    let (socket, address) = station();
    let flight = Flight::begin(&temp, &[&file, "--speed", "20", "--mavlink", &address, "--json"]);
    let began = Instant::now();
    while !written(&temp.0) {
        assert!(began.elapsed() < PATIENCE);
        std::thread::sleep(Duration::from_millis(20));
    }
    await_datagram(&socket, |datagram| heartbeat(datagram, false));
    let output = flight.end();
    assert_eq!(output.status.code(), Some(1));
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(summary["accomplished"], false, "{summary}");
}

#[test]
fn ctrl_c_in_the_air_ends_the_mission_with_a_report() {
    let temp = Temp::new("live-stopped");
    let file = temp.file("hop.toml", HOP);
    let (socket, address) = station();
    let flight = Flight::begin(&temp, &[&file, "--speed", "5", "--mavlink", &address]);
    await_datagram(&socket, |datagram| heartbeat(datagram, true));
    let output = flight.end();
    assert_eq!(output.status.code(), Some(1));
    let message = text(&output.stderr);
    assert!(
        message.contains("sophie: not accomplished: stopped from outside (at "),
        "{message}"
    );
    assert!(written(&temp.0));
}

#[test]
fn without_a_pilot_it_waits_on_the_ground_and_leaves_no_report() {
    let temp = Temp::new("live-none");
    let (socket, address) = station();
    let flight = Flight::begin(&temp, &["--pilot", "none", "--speed", "5", "--mavlink", &address]);
    let board = await_datagram(&socket, |datagram| heartbeat(datagram, false));
    // A client that speaks first is served beside the destination.
    let (client, _) = station();
    client.send_to(&[0xFD], board).unwrap();
    await_datagram(&client, |datagram| heartbeat(datagram, false));
    await_datagram(&socket, |datagram| heartbeat(datagram, false));
    let output = flight.end();
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    assert!(text(&output.stdout).ends_with("waits until Ctrl-C\n"));
    assert!(!temp.0.join("out").exists());
}

/// A builder who replies to `sophie bringup` with `replies`, then stops; what was said, and the exit status.
fn led(temp: &Temp, address: &str, replies: &str) -> Output {
    let port = format!("udpin:{address}");
    let mut child = command(&temp.0, &["bringup", "--port", &port, "--patience", "20"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(replies.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

#[test]
fn a_bring_up_begins_at_the_simulated_vehicle() {
    let temp = Temp::new("live-bringup");
    let (socket, address) = station();
    drop(socket);
    let _flight = Flight::begin(&temp, &["--pilot", "none", "--speed", "5", "--mavlink", &address]);
    // It has no chip: skipped. The capacity is changed, which stores and restarts; the sticks of a radio are not there.
    let replies = "s\n\n\n\n5400\n\n\n\n\n\nq\n";
    let output = led(&temp, &address, replies);
    let said = text(&output.stdout);
    assert_eq!(
        (output.status.code(), text(&output.stderr).as_str()),
        (Some(1), ""),
        "{said}"
    );
    for line in [
        "battery_capacity 6480 -> 5400 A s",
        "the board restarts",
        "pass  inertial sensor",
        "(live-air)",
    ] {
        assert!(said.contains(line), "{line}: {said}");
    }
    assert!(
        said.contains("\nStopped. skipped: chip; not done: live-air"),
        "{said}"
    );
}

#[test]
#[ignore = "wants pymavlink, which .ci/mavlink-clients installs: .ci/run runs it"]
fn pymavlink_hears_the_vehicle() {
    let temp = Temp::new("live-pymavlink");
    let file = temp.file("hop.toml", HOP);
    let (socket, address) = station();
    drop(socket);
    let _flight = Flight::begin(&temp, &[&file, "--speed", "2", "--mavlink", &address]);
    let heard = clients::listen(&format!("udpin:{address}"), 3, &["HEARTBEAT", "ATTITUDE"]);
    assert_eq!((&heard["bad"], &heard["lost"]), (&0.into(), &0.into()), "{heard}");
    for beat in heard["messages"]["HEARTBEAT"].as_array().unwrap() {
        // MAV_TYPE_QUADROTOR, MAV_AUTOPILOT_GENERIC.
        assert_eq!(
            (&beat["type"], &beat["autopilot"], &beat["system"]),
            (&2.into(), &0.into(), &1.into()),
            "{beat}"
        );
    }
    // Before it is armed and in the first seconds of a climb: near level.
    for attitude in heard["messages"]["ATTITUDE"].as_array().unwrap() {
        for angle in ["roll", "pitch"] {
            let lean = attitude[angle].as_f64().unwrap();
            assert!(lean.abs() < 0.2, "{attitude}");
        }
    }
}

#[test]
#[ignore = "wants pymavlink, which .ci/mavlink-clients installs: .ci/run runs it"]
fn pymavlink_signs_and_what_it_has_said_is_not_taken_again() {
    let temp = Temp::new("live-signing");
    let key = temp.file(
        "key",
        b"00112233445566778899aabbccddeeff00112233445566778899aabbccddeeff\n",
    );
    let (socket, address) = station();
    drop(socket);
    let args = ["--pilot", "none", "--mavlink", &address, "--mavlink-key", &key];
    let _flight = Flight::begin(&temp, &args);
    let result = clients::run("signing.py", &[&format!("udpin:{address}"), &key]);
    assert!(
        result["good"].as_u64().unwrap() > 50 && result["recorded"].as_u64().unwrap() > 5,
        "{result}"
    );
}

#[test]
fn a_file_without_a_key_is_named() {
    let temp = Temp::new("live-key");
    let file = temp.file("key", b"0011\n");
    let output = command(
        &temp.0,
        &["fly", "--live", "--pilot", "none", "--mavlink-key", &file],
    )
    .output()
    .unwrap();
    assert_eq!(output.status.code(), Some(2));
    let message = text(&output.stderr);
    assert!(
        message.contains(": no key: 64 hexadecimal digits are expected"),
        "{message}"
    );
    assert_eq!(message.lines().count(), 1, "{message}");
}

/// `MAV_RESULT`.
const ACCEPTED: u8 = 0;
const REJECTED: u8 = 1;
const DENIED: u8 = 2;
/// Commands of the standard.
const GRIPPER: u16 = 211;
const ARM: u16 = 400;

fn said(heard: &serde_json::Value, text: &str) -> bool {
    let texts = heard["texts"].as_array().unwrap();
    texts.iter().any(|said| said == text)
}

#[test]
#[ignore = "wants pymavlink, which .ci/mavlink-clients installs: .ci/run runs it"]
fn pymavlink_tries_a_motor_and_calibrates_without_a_radio_and_cannot_arm() {
    let temp = Temp::new("live-bench");
    let (socket, address) = station();
    drop(socket);
    let _flight = Flight::begin(&temp, &["--pilot", "none", "--mavlink", &address]);
    let (motor, servo, calibration, propellers_off) = (209, 183, 241, 31_010);
    let steps = serde_json::json!([
        // Calibrating until now: disarmed after the first.
        [calibration, [1], ACCEPTED],
        [ARM, [1], REJECTED],
        [ARM, [1, 21196], DENIED],
        [GRIPPER, [1, 1], REJECTED],
        [motor, [2, 0, 8], REJECTED],
        [propellers_off, [1], ACCEPTED],
        [motor, [2, 0, 13], DENIED],
        [motor, [2, 0, 8, 1], ACCEPTED],
        [servo, [6, 1400], ACCEPTED],
        [servo, [6, 0], ACCEPTED],
        [calibration, [0, 0, 0, 0, 2], ACCEPTED],
        [ARM, [0, 21196], ACCEPTED],
    ]);
    let heard = clients::obey(&format!("udpin:{address}"), &steps);
    for text in [
        "arming: radio lost",
        "refused: no arming check can be forced",
        "refused: radio lost",
        "refused: say 'propellers off' first, once they are",
        "refused: out of range",
        "calibration: put the vehicle on a level table",
        "calibration: done",
    ] {
        assert!(said(&heard, text), "{text}: {heard}");
    }
}

#[test]
#[ignore = "wants pymavlink, which .ci/mavlink-clients installs: .ci/run runs it"]
fn pymavlink_arms_where_the_pilots_switch_is_on_and_grabs_in_flight_alone() {
    clients::python();
    let temp = Temp::new("live-orders");
    let file = temp.file("hop.toml", HOP);
    let (socket, address) = station();
    drop(socket);
    // Slow enough for a client on a busy machine to be there before the pilot arms, 4 s after the start.
    let _flight = Flight::begin(&temp, &[&file, "--speed", "0.25", "--mavlink", &address]);
    let steps = serde_json::json!([
        // Until the pilot turns his arm switch on, a second before his gesture ends.
        [ARM, [1], REJECTED],
        [GRIPPER, [1, 1], REJECTED],
        [ARM, [1], ACCEPTED],
        [GRIPPER, [1, 1], ACCEPTED],
        [GRIPPER, [1, 0], ACCEPTED],
        [ARM, [0], REJECTED],
        [ARM, [0, 21196], ACCEPTED],
        [GRIPPER, [1, 1], REJECTED],
    ]);
    let heard = clients::obey(&format!("udpin:{address}"), &steps);
    for text in [
        "refused: only in flight or on the pipe",
        "refused: flying: land first",
    ] {
        assert!(said(&heard, text), "{text}: {heard}");
    }
    let refused = ["refused: arm switch off", "arming: not calibrated"];
    assert!(refused.iter().any(|text| said(&heard, text)), "{heard}");
}

/// The last row of numbers that `watch` has shown.
fn row(said: &serde_json::Value) -> Vec<f64> {
    let rows = said.as_array().unwrap().iter().rev();
    let numbers = rows.filter_map(|row| {
        let words = row.as_array().unwrap().iter();
        let numbers: Option<Vec<f64>> = words.map(|word| word.as_str().unwrap().parse().ok()).collect();
        numbers.filter(|numbers| numbers.len() > 5)
    });
    numbers.into_iter().next().unwrap_or_default()
}

#[test]
#[ignore = "wants pymavlink, which .ci/mavlink-clients installs: .ci/run runs it"]
fn pymavlink_sends_poses_and_reads_them_at_the_console() {
    let temp = Temp::new("live-inputs");
    let (socket, address) = station();
    drop(socket);
    let _flight = Flight::begin(&temp, &["--pilot", "none", "--mavlink", &address]);
    let said = clients::run("inputs.py", &[&format!("udpin:{address}"), "60"]);
    // North, east, down; roll, pitch, yaw; velocity.
    assert_eq!(
        row(&said["odometry"]),
        [2.0, 1.5, -3.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
        "{said}"
    );
    for (name, pose) in [
        ("vision", [1.5, -2.0, -3.0, 10.0, 0.0, 0.0]),
        ("mocap", [1.5, 0.5, -0.5, 30.0, 0.0, 0.0]),
    ] {
        let rows = said[name].as_array().unwrap();
        let seen = rows.iter().any(|row| {
            let words: Vec<f64> = row
                .as_array()
                .unwrap()
                .iter()
                .flat_map(|w| w.as_str().unwrap().parse())
                .collect();
            // Its velocity is not known.
            words.len() == 6 && words.iter().zip(pose).all(|(a, b)| (a - b).abs() < 0.3)
        });
        assert!(seen, "{name}: {said}");
    }
    let lines = said["mavlink"].as_array().unwrap();
    let inputs = lines
        .iter()
        .find_map(|line| line.as_str().unwrap().strip_prefix("inputs: "));
    let inputs = inputs.unwrap();
    assert!(!inputs.starts_with("0 poses, 0 "), "{inputs}");
    assert!(
        inputs.contains("; refused 0 system, 0 source, 0 frame, 1 value, "),
        "{inputs}"
    );
}

/// Every parameter of the table, by name.
fn whole_table(params: &serde_json::Value) -> bool {
    let params = params.as_object().unwrap();
    let table = sophie_control::params::Params::TABLE;
    params.len() == table.len() && table.iter().all(|row| params.contains_key(row.name))
}

#[test]
#[ignore = "wants MAVSDK, which .ci/mavlink-clients installs: .ci/run runs it"]
fn mavsdk_hears_sets_is_refused_and_has_a_shell() {
    let temp = Temp::new("live-mavsdk");
    let (socket, address) = station();
    drop(socket);
    let _flight = Flight::begin(&temp, &["--pilot", "none", "--mavlink", &address]);
    let did = clients::run("sdk.py", &[&format!("udpin://{address}"), "60", "stands"]);
    let near = |value: &serde_json::Value, wanted: f64, within: f64| {
        value
            .as_f64()
            .is_some_and(|value| (value - wanted).abs() < within)
    };
    assert!(
        near(&did["attitude"][0], 0.0, 5.0) && near(&did["attitude"][1], 0.0, 5.0),
        "{did}"
    );
    assert!(near(&did["voltage"], 16.0, 1.0) && did["armed"] == false, "{did}");
    assert!(whole_table(&did["params"]), "{did}");
    let count = sophie_control::params::Params::TABLE.len();
    assert_eq!(
        (&did["others"], &did["one_by_one"]),
        (&0.into(), &count.into()),
        "{did}"
    );
    assert!(
        did["set"] == "SUCCESS" && near(&did["infill"], 8.0, 1e-6),
        "{did}"
    );
    assert!(
        did["beyond"] != "SUCCESS" && near(&did["infill_after"], 8.0, 1e-6),
        "{did}"
    );
    // Without a radio, on the ground.
    assert_eq!(did["arm"], "COMMAND_DENIED", "{did}");
    assert!(did["grab"] != "SUCCESS" && did["release"] != "SUCCESS", "{did}");
    assert!(said(&did, "refused: radio lost"), "{did}");
    // The console's working copy has not what was set by the parameter protocol.
    let shell = did["shell"].as_str().unwrap();
    assert!(
        shell.contains("infill           6.9") && shell.ends_with("\n> "),
        "{did}"
    );
}

#[test]
#[ignore = "wants MAVProxy, which .ci/mavlink-clients installs: .ci/run runs it"]
fn mavproxy_fetches_loads_and_saves_parameters() {
    let temp = Temp::new("live-mavproxy");
    let (socket, address) = station();
    drop(socket);
    let _flight = Flight::begin(&temp, &["--pilot", "none", "--mavlink", &address]);
    let did = clients::run("proxy.py", &[&format!("udpin:{address}"), "60", "infill", "8"]);
    assert!(whole_table(&did["params"]), "{did}");
    assert_eq!(did["params"]["infill"], 8.0, "{did}");
}
