//! `sophie fly --live`: a flight at the pace of real time, with MAVLink on UDP.

use std::sync::Arc;
use std::sync::atomic::Ordering;

use sophie_flight_report::terminal::live::watch;
use sophie_sim::flight::live::LiveFlight;
use sophie_sim::live::{Live, Pace, Udp};
use sophie_terminal::complain;
use sophie_terminal::console::Console;

use super::args::{FlyArgs, LiveArgs};
use super::interrupt::on_ctrl_c;
use super::{PROGRAM, introduce, key, report};

/// Flies the mission, reports it and waits for Ctrl-C; without a pilot, only waits. False when the mission was not
/// accomplished.
pub fn run(args: &FlyArgs) -> Result<bool, String> {
    let scenario = args.mission.scenario()?;
    let LiveArgs {
        speed,
        mavlink,
        pilot,
        ref mavlink_key,
        ..
    } = args.live;
    let key = mavlink_key.as_deref().map(key::read).transpose()?;
    let udp = Udp::open(mavlink).map_err(|why| format!("--mavlink {why}"))?;
    let stop = on_ctrl_c()?;
    let console = Console::new(args.json);
    let clients = format!("MAVLink: {}", udp.shown());
    let live = Live::new(Pace::new(speed), udp, Arc::clone(&stop), |line| {
        complain(PROGRAM, line)
    })
    .with_key(key);
    let mut flight = LiveFlight::new(&scenario, live);
    let mut accomplished = true;
    if pilot.is_none() {
        let out = args.report_directory()?;
        introduce(&scenario, &console);
        console.say(&clients);
        let record = watch(&console, |observer| flight.fly(observer));
        accomplished = report(&record, out.as_ref(), &console, args.json)?;
    } else {
        console.say(&clients);
    }
    if !stop.load(Ordering::Relaxed) {
        console.say("waits until Ctrl-C");
        flight.wait();
    }
    Ok(accomplished)
}
