//! The bytes that a link may take, and the table of streams in docs/mavlink.md.
//!
//! `WRITE_DOCS=1 cargo test --package sophie-mavlink --test mavlink table_of` rewrites the table.

use std::fmt::Write;

use sophie_control::mode::Mode;
use sophie_dialect::*;
use sophie_mavlink::services::streams::{STREAMS, Stream};

use crate::page::hold;
use crate::station::{Station, frame, vehicle};

/// A line of 57,600 baud with a fifth to spare: the slowest that is any use.
const SLOWEST: u32 = 57_600 / 10 * 4 / 5;

/// Every stream at its own rate with no zero left out, bytes each second.
fn sum() -> u32 {
    let streams = STREAMS.iter().filter(|stream| stream.period_ms > 0);
    streams.map(|s| s.bytes * 1000 / s.period_ms).sum()
}

fn table() -> String {
    let mut text = String::from(
        "| message | number | period | bytes | bytes each second |\n|---|---:|---:|---:|---:|\n",
    );
    for s in &STREAMS {
        let Stream { name, id, bytes, .. } = s;
        let (period, rate) = match s.period_ms {
            0 => ("on request".to_owned(), 0),
            ms => (format!("{ms} ms"), bytes * 1000 / ms),
        };
        writeln!(text, "| `{name}` | {id} | {period} | {bytes} | {rate} |").unwrap();
    }
    writeln!(text, "| all | | | | {} |", sum()).unwrap();
    text
}

#[test]
fn the_table_of_streams_in_the_docs_is_the_codes() {
    hold("streams", &table());
}

#[test]
fn all_streams_at_their_own_rates_fit_the_slowest_line_and_are_kept_there() {
    assert!(sum() < SLOWEST * 3 / 4, "{}", sum());
    let mut station = Station::with(SLOWEST);
    station.vehicle = vehicle(Mode::Flight);
    station.run(10_000);
    for stream in &STREAMS {
        let got = station.sent.iter().filter(|sent| sent.id == stream.id).count() as u32;
        let due = 10_000u32.checked_div(stream.period_ms).unwrap_or(0);
        assert!(got.abs_diff(due) <= 1, "{}: {got} of {due}", stream.name);
    }
}

/// Most bytes within any `window` µs.
fn most(station: &Station, window: u64) -> usize {
    let sent = &station.sent;
    let from = |at: u64| {
        let within = sent.iter().filter(move |s| (at..at + window).contains(&s.at));
        within.map(|s| s.bytes).sum()
    };
    sent.iter().map(|s| from(s.at)).max().unwrap_or(0)
}

#[test]
fn requested_streams_stay_within_the_budget_and_heartbeats_and_answers_come_first() {
    let mut station = Station::with(1500);
    station.vehicle = vehicle(Mode::Flight);
    for stream in STREAMS.iter().filter(|s| s.id != 0) {
        let results = station.command(MavCmd::MAV_CMD_SET_MESSAGE_INTERVAL, [stream.id as f32, 20_000.0]);
        assert_eq!(results, [0], "{}", stream.name);
    }
    station.run(2000);
    station.sent.clear();
    for asked in 1..=100 {
        // A list of all parameters each time, and a question that is answered.
        station.say(&frame(&PARAM_REQUEST_LIST_DATA {
            target_system: 1,
            target_component: 1,
        }));
        station.say(&frame(&TIMESYNC_DATA {
            ts1: asked,
            ..Default::default()
        }));
        station.run(100);
    }
    // What may have been saved up comes on top.
    assert!(
        most(&station, 1_000_000) <= 1500 + 400,
        "{}",
        most(&station, 1_000_000)
    );
    let total: usize = station.sent.iter().map(|s| s.bytes).sum();
    assert!((13_000..15_500).contains(&total), "{total}");
    let answers = station.got::<TIMESYNC_DATA>();
    assert_eq!(answers.len(), 100);
    let beats = station.got::<HEARTBEAT_DATA>().len();
    assert!((10..=11).contains(&beats), "{beats}");
}

#[test]
fn a_flood_of_questions_costs_its_line_alone() {
    let mut station = Station::new();
    let question = frame(&TIMESYNC_DATA {
        ts1: 1,
        ..Default::default()
    });
    for _ in 0..500 {
        // 115,200 baud, full.
        station.say(&question.repeat(230 / question.len()));
        station.run(20);
    }
    assert!(most(&station, 1_000_000) <= 5000 + 1250);
    let beats = station.got::<HEARTBEAT_DATA>().len();
    assert!((10..=11).contains(&beats), "{beats}");
}
