//! Commands, and what each is answered with; the table of commands in docs/mavlink.md.
//!
//! `WRITE_DOCS=1 cargo test --package sophie-mavlink --test mavlink table_of` rewrites the table.

use std::collections::BTreeSet;
use std::fmt::Write;

use num_traits::FromPrimitive;
use sophie_control::mode::Mode;
use sophie_dialect::*;
use sophie_mavlink::Order;
use sophie_mavlink::services::commands::{OBEYED, Obeyed, When};

use crate::page::hold;
use crate::station::{Station, frame, vehicle};

const ACCEPTED: u8 = 0;
const REJECTED: u8 = 1;
const DENIED: u8 = 2;
const UNSUPPORTED: u8 = 3;

#[test]
fn what_is_not_known_is_answered_as_unsupported() {
    let mut station = Station::new();
    for command in [16, 22, 176, 511 + 20_000, 65_535] {
        assert_eq!(
            station.command_to(1, 1, command, [0.0; 2]),
            [UNSUPPORTED],
            "{command}"
        );
    }
    station.sent.clear();
    station.say(&frame(&COMMAND_INT_DATA {
        command: 192,
        target_system: 1,
        target_component: 1,
        ..Default::default()
    }));
    station.run(100);
    let ack = &station.got::<COMMAND_ACK_DATA>()[0];
    assert_eq!((ack.command, ack.result), (192, UNSUPPORTED));
}

#[test]
fn a_message_is_sent_when_asked_for() {
    let mut station = Station::new();
    let ask = MavCmd::MAV_CMD_REQUEST_MESSAGE;
    assert_eq!(station.command(ask, [148.0, 0.0]), [ACCEPTED]);
    assert_eq!(station.got::<AUTOPILOT_VERSION_DATA>().len(), 1);
    // Clients wait for the acknowledgement, and then for the message.
    let place = |id| station.sent.iter().position(|sent| sent.id == id);
    assert!(place(77) < place(148));
    assert_eq!(station.command(ask, [435.0, 0.0]), [ACCEPTED]);
    station.run(1000);
    let modes = station.got::<AVAILABLE_MODES_DATA>();
    assert!(modes.iter().map(|m| m.mode_index).eq(1..=Mode::ALL.len() as u8));
    // Which of them is not given: all.
    assert_eq!(station.command(ask, [435.0, f32::NAN]), [ACCEPTED]);
    station.run(1000);
    assert_eq!(station.got::<AVAILABLE_MODES_DATA>().len(), Mode::ALL.len());
    assert_eq!(station.command(ask, [435.0, 4.0]), [ACCEPTED]);
    assert_eq!(
        station.got::<AVAILABLE_MODES_DATA>()[0].custom_mode,
        Mode::Flight as u32
    );
    let none = Mode::ALL.len() as f32 + 1.0;
    assert_eq!(station.command(ask, [435.0, none]), [DENIED]);
    assert_eq!(station.command(ask, [33.0, 0.0]), [UNSUPPORTED]);
    for bad in [f32::NAN, -1.0, 0.5, f32::INFINITY] {
        assert_eq!(station.command(ask, [bad, 0.0]), [DENIED], "{bad}");
    }
}

#[test]
fn an_interval_can_be_set_read_and_taken_back() {
    let mut station = Station::new();
    let set = MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL;
    let read = |station: &mut Station| {
        assert_eq!(
            station.command(MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL, [30.0, 0.0]),
            [ACCEPTED]
        );
        station.got::<MESSAGE_INTERVAL_DATA>()[0].interval_us
    };
    assert_eq!(read(&mut station), 100_000);
    assert_eq!(station.command(set, [30.0, 40_000.0]), [ACCEPTED]);
    assert_eq!(read(&mut station), 40_000);
    station.sent.clear();
    station.run(2000);
    assert_eq!(station.got::<ATTITUDE_DATA>().len(), 50);
    assert_eq!(station.command(set, [30.0, -1.0]), [ACCEPTED]);
    assert_eq!(read(&mut station), -1);
    station.sent.clear();
    station.run(1000);
    assert!(station.got::<ATTITUDE_DATA>().is_empty());
    assert_eq!(station.command(set, [30.0, 0.0]), [ACCEPTED]);
    assert_eq!(read(&mut station), 100_000);
    assert_eq!(station.command(set, [30.0, 19_999.0]), [DENIED]);
    assert_eq!(station.command(set, [0.0, -1.0]), [DENIED]);
    assert_eq!(station.command(set, [33.0, 100_000.0]), [UNSUPPORTED]);
    for bad in [
        f32::NAN,
        -2.0,
        -0.5,
        -100_000.0,
        4_294_967_296.0,
        2_147_483_648.0,
        f32::INFINITY,
    ] {
        assert_eq!(station.command(set, [30.0, bad]), [DENIED], "{bad}");
    }
    assert_eq!(read(&mut station), 100_000);
    // The longest that MESSAGE_INTERVAL can say, of those that a float has.
    assert_eq!(station.command(set, [30.0, 2_147_483_520.0]), [ACCEPTED]);
    assert_eq!(read(&mut station), 2_147_483_520);
}

#[test]
fn the_vehicles_time_and_a_ping_are_answered() {
    let mut station = Station::new();
    station.run(1000);
    station.say(&frame(&TIMESYNC_DATA {
        ts1: -77,
        ..Default::default()
    }));
    // An answer to another's question is none to answer.
    station.say(&frame(&TIMESYNC_DATA {
        tc1: 5,
        ts1: 78,
        ..Default::default()
    }));
    station.say(&frame(&PING_DATA {
        time_usec: 12,
        seq: 34,
        ..Default::default()
    }));
    station.run(100);
    let syncs = station.got::<TIMESYNC_DATA>();
    assert_eq!(syncs.len(), 1);
    assert_eq!((syncs[0].tc1, syncs[0].ts1), (1_000_000_000, -77));
    let ping = &station.got::<PING_DATA>()[0];
    assert_eq!(
        (
            ping.time_usec,
            ping.seq,
            ping.target_system,
            ping.target_component
        ),
        (12, 34, 255, 190)
    );
}

#[test]
fn it_restarts_after_the_answer_and_at_rest_alone() {
    for mode in Mode::ALL {
        let mut station = Station::new();
        station.vehicle = vehicle(mode);
        let results = station.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, [1.0, 0.0]);
        let allowed = matches!(mode, Mode::Disarmed | Mode::Calibrating);
        assert_eq!(results, [if allowed { ACCEPTED } else { REJECTED }], "{mode:?}");
        assert!(station.orders.is_empty());
        station.run(1000);
        assert_eq!(station.orders.contains(&Order::Restart), allowed, "{mode:?}");
        assert_eq!(
            station.texts().contains(&"refused: disarm first".into()),
            !allowed,
            "{mode:?}"
        );
    }
    let mut station = Station::new();
    // Shut down, stay in the loader: not here.
    for what in [2.0, 3.0] {
        let results = station.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, [what, 0.0]);
        assert_eq!(results, [UNSUPPORTED]);
    }
    // Armed meanwhile.
    assert_eq!(
        station.command(MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, [1.0, 0.0]),
        [ACCEPTED]
    );
    station.vehicle = vehicle(Mode::Armed);
    station.run(1000);
    assert!(station.orders.is_empty());
}

/// The table of the page.
fn table() -> String {
    let mut text = String::from("| command | number | parameters | when |\n|---|---:|---|---|\n");
    for Obeyed { command, form, when } in &OBEYED {
        let name = format!("{command:?}").replace("MAV_CMD_", "");
        let when = match when {
            When::Always => "always",
            When::AtRest => "DISARMED, CALIBRATING",
            When::Commander(when) => when,
        };
        writeln!(text, "| `{name}` | {} | {form} | {when} |", *command as u32).unwrap();
    }
    text
}

#[test]
fn the_table_of_commands_in_the_docs_is_the_codes() {
    hold("commands", &table());
}

#[test]
fn the_commands_of_the_table_are_those_that_are_obeyed_and_when() {
    let named: BTreeSet<u32> = OBEYED.iter().map(|row| row.command as u32).collect();
    let known = (0..=u16::MAX.into()).filter_map(MavCmd::from_u32);
    let obeyed: BTreeSet<u32> = known
        .filter(|command| {
            let answered = Station::new().command(*command, [1.0, 0.0]);
            !answered.contains(&UNSUPPORTED)
        })
        .map(|command| command as u32)
        .collect();
    assert_eq!(named, obeyed);
    for row in OBEYED.iter().filter(|row| row.when == When::AtRest) {
        for mode in Mode::ALL {
            let mut station = Station::new();
            station.vehicle = vehicle(mode);
            let rejected = station.command(row.command, [1.0, 0.0]).contains(&REJECTED);
            let rests = matches!(mode, Mode::Disarmed | Mode::Calibrating);
            assert_eq!(rejected, !rests, "{row:?} {mode:?}");
        }
    }
}

#[test]
fn who_asks_with_numbers_that_there_are_not_reads_why() {
    let mut station = Station::new();
    for (command, numbers, result, text) in [
        (
            MavCmd::MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN,
            [2.0, 0.0],
            UNSUPPORTED,
            "refused: 1 restarts, nothing else",
        ),
        (
            MavCmd::MAV_CMD_PREFLIGHT_STORAGE,
            [0.0, 0.0],
            UNSUPPORTED,
            "refused: 1 stores, nothing else",
        ),
        (
            MavCmd::MAV_CMD_PREFLIGHT_CALIBRATION,
            [0.0, 1.0],
            UNSUPPORTED,
            "refused: others: MAV_CMD_SOPHIE_CALIBRATE",
        ),
        (
            MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL,
            [30.0, 19_999.0],
            DENIED,
            "refused: an interval is 20 ms to 35 min, 0 or -1",
        ),
        (
            MavCmd::MAV_CMD_REQUEST_MESSAGE,
            [435.0, 99.0],
            DENIED,
            "refused: no such mode",
        ),
        (
            MavCmd::MAV_CMD_GET_MESSAGE_INTERVAL,
            [f32::NAN, 0.0],
            DENIED,
            "refused: no message has that number",
        ),
    ] {
        station.sent.clear();
        assert_eq!(station.command(command, numbers), [result], "{command:?}");
        station.run(200);
        assert!(
            station.texts().iter().any(|said| said == text),
            "{text}: {:?}",
            station.texts()
        );
    }
}
