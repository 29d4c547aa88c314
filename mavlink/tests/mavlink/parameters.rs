//! The parameter protocol.

use std::collections::BTreeSet;

use sophie_control::mode::Mode;
use sophie_control::params::Params;
use sophie_dialect::*;
use sophie_mavlink::Order;

use crate::station::{Station, frame, frame_from, vehicle};

fn id(name: &str) -> mavlink_core::types::CharArray<16> {
    sophie_mavlink::services::telemetry::text::<16>(name).into()
}

fn set(station: &mut Station, name: &str, value: f32) {
    set_as(station, name, value, 9);
}

fn set_as(station: &mut Station, name: &str, value: f32, kind: u8) {
    station.say(&frame(&PARAM_SET_DATA {
        param_value: value,
        target_system: 1,
        target_component: 1,
        param_id: id(name),
        param_type: kind,
    }));
    station.run(100);
}

fn echo(station: &mut Station) -> Vec<f32> {
    let values = station.got::<PARAM_VALUE_DATA>();
    station.sent.clear();
    values.iter().map(|v| v.param_value).collect()
}

#[test]
fn a_list_has_every_parameter_once_in_order() {
    let mut station = Station::new();
    station.say(&frame(&PARAM_REQUEST_LIST_DATA {
        target_system: 1,
        target_component: 1,
    }));
    station.run(10_000);
    let all = station.got::<PARAM_VALUE_DATA>();
    assert_eq!(all.len(), Params::TABLE.len());
    for (at, (row, value)) in Params::TABLE.iter().zip(&all).enumerate() {
        assert_eq!(value.param_id.to_str().unwrap(), row.name);
        assert_eq!(
            (usize::from(value.param_index), usize::from(value.param_count)),
            (at, all.len())
        );
        assert_eq!((value.param_value, value.param_type), (row.default, 9));
    }
}

#[test]
fn who_asks_for_a_list_beside_another_starves_no_one() {
    // Each asks again before a list could be sent, as over a slow link; the first goes on none the less.
    let mut station = Station::with(1500);
    let count = Params::TABLE.len();
    let list = |system| {
        frame_from(
            system,
            &PARAM_REQUEST_LIST_DATA {
                target_system: 1,
                target_component: 1,
            },
        )
    };
    let places = |station: &Station| -> Vec<usize> {
        let values = station.got::<PARAM_VALUE_DATA>();
        values.iter().map(|v| v.param_index.into()).collect()
    };
    for _ in 0..40 {
        station.say(&list(255));
        station.run(500);
        station.say(&list(254));
        station.run(500);
    }
    let heard: BTreeSet<usize> = places(&station).into_iter().collect();
    assert_eq!(heard.len(), count);
    // It comes to an end: who asked last has heard all of it by then.
    station.sent.clear();
    station.say(&list(254));
    station.run(60_000);
    let last = places(&station);
    assert_eq!(last.len(), count);
    assert_eq!(last.into_iter().collect::<BTreeSet<_>>().len(), count);
}

#[test]
fn one_is_read_by_name_or_place() {
    let mut station = Station::new();
    for (name, index) in [("infill", -1), ("INFILL", -1), ("", 2), ("mass", 2)] {
        station.sent.clear();
        station.say(&frame(&PARAM_REQUEST_READ_DATA {
            param_index: index,
            target_system: 1,
            target_component: 1,
            param_id: id(name),
        }));
        station.run(100);
        let expected = if index < 0 {
            name.to_lowercase()
        } else {
            Params::TABLE[2].name.to_owned()
        };
        assert_eq!(
            station.got::<PARAM_VALUE_DATA>()[0].param_id.to_str().unwrap(),
            expected
        );
    }
    for (name, index) in [("nothing", -1), ("", -1), ("mass", 30_000), ("mass", -2)] {
        station.sent.clear();
        station.say(&frame(&PARAM_REQUEST_READ_DATA {
            param_index: index,
            target_system: 1,
            target_component: 1,
            param_id: id(name),
        }));
        station.run(100);
        let known = index < 0 && name == "mass";
        assert_eq!(
            station.got::<PARAM_VALUE_DATA>().len(),
            usize::from(known),
            "{name} {index}"
        );
    }
}

#[test]
fn a_change_is_echoed_and_stored_once_a_second_after_the_last() {
    let mut station = Station::new();
    station.run(1000);
    station.sent.clear();
    set(&mut station, "infill", 8.0);
    assert_eq!(echo(&mut station), [8.0]);
    station.run(800);
    set(&mut station, "mass", 2.0);
    station.run(800);
    assert!(station.orders.is_empty());
    station.run(200);
    assert_eq!(station.orders, [Order::Store]);
    assert_eq!(
        (station.server.params().infill, station.server.params().mass),
        (8.0, 2.0)
    );
    station.server.stored(Ok(()));
    station.run(5000);
    assert_eq!(station.orders, [Order::Store]);
    assert!(
        station
            .texts()
            .contains(&"parameters stored: in force after a restart".into())
    );
}

#[test]
fn what_is_not_allowed_is_answered_with_the_old_value_and_a_reason() {
    let mut station = Station::new();
    for bad in [f32::NAN, f32::INFINITY, 3.9, 11.0, -1e30] {
        set(&mut station, "infill", bad);
        assert_eq!(echo(&mut station), [6.9], "{bad}");
    }
    set(&mut station, "motor_protocol", 301.0);
    assert_eq!(echo(&mut station), [300.0]);
    set_as(&mut station, "infill", 8.0, 6);
    assert_eq!(echo(&mut station), [6.9]);
    set(&mut station, "nothing", 1.0);
    assert_eq!(station.texts(), ["no such parameter"]);
    assert_eq!(echo(&mut station), [0.0; 0]);
    set(&mut station, "infill", 11.0);
    assert_eq!(station.texts(), ["infill: not an allowed value"]);
    station.run(5000);
    assert!(station.orders.is_empty());
    assert!(*station.server.params() == Params::DEFAULT);
}

#[test]
fn armed_the_old_value_is_echoed_and_nothing_is_stored() {
    for mode in Mode::ALL {
        let mut station = Station::new();
        station.vehicle = vehicle(mode);
        set(&mut station, "infill", 8.0);
        let allowed = matches!(mode, Mode::Disarmed | Mode::Calibrating);
        assert_eq!(echo(&mut station), [if allowed { 8.0 } else { 6.9 }], "{mode:?}");
        // Set at rest, armed before it was stored: it waits.
        station.vehicle = vehicle(Mode::Flight);
        station.run(5000);
        assert!(station.orders.is_empty(), "{mode:?}");
        station.vehicle = vehicle(Mode::Disarmed);
        station.run(100);
        assert_eq!(station.orders.contains(&Order::Store), allowed, "{mode:?}");
    }
}
