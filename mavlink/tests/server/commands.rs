//! Commands, and what each is answered with.

use std::collections::BTreeSet;

use num_traits::FromPrimitive;
use sophie_control::mode::Mode;
use sophie_mavlink::Order;
use sophie_mavlink::dialect::*;

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
    assert_eq!(station.command(set, [30.0, f32::NAN]), [DENIED]);
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

#[test]
fn the_commands_of_the_page_are_those_that_are_obeyed() {
    let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/mavlink.md");
    let page = std::fs::read_to_string(page).unwrap();
    let (_, rest) = page.split_once("| command | when |\n").unwrap();
    let (table, _) = rest.split_once("\n\n").unwrap();
    // What stands in backticks in the first column.
    let first = table.lines().filter_map(|row| row.split('|').nth(1));
    let named: BTreeSet<String> = first
        .flat_map(|column| column.split('`').skip(1).step_by(2))
        .map(|name| format!("MAV_CMD_{name}"))
        .collect();
    let known = (0..=u16::MAX.into()).filter_map(MavCmd::from_u32);
    let obeyed: BTreeSet<String> = known
        .filter(|command| {
            let answered = Station::new().command(*command, [1.0, 0.0]);
            !answered.contains(&UNSUPPORTED)
        })
        .map(|command| format!("{command:?}"))
        .collect();
    assert_eq!(named, obeyed);
}
