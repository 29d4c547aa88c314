//! The defmt log of the running firmware. Background: logging never delays a flight.
//!
//! At the start it logs the duration of the start and the chip's checks; a line at each change of state, reason,
//! warning or hardware arming inhibit, for each arm of a proven grip, and for the thrust factor as a flight ends; each
//! second the timing of every task and missed deadlines ([`super::timing`]), and the greatest stack depth if it has grown.

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Ticker};
use sophie_control::arming::{ArmingInhibit, ArmingInhibits};
use sophie_ports::chip_check::ChipCheck;
use sophie_tasks::links::Links;
use sophie_tasks::links::messages::Status;

use super::grip::GripReport;
use super::timing::TimingReport;

const PERIOD: Duration = Duration::from_millis(50);
/// Polls per second, one for each task's timing and the chains', to avoid a burst.
const SECOND: u32 = 20;

/// Logs each second and at each change; never returns.
pub async fn run(links: &Links, checks: &[ChipCheck]) -> ! {
    // The clock starts some milliseconds after the reset, with the chip's clocks.
    defmt::info!("started in {=u64} ms", Instant::now().as_millis());
    let mut ticker = Ticker::every(PERIOD);
    let mut shown: Option<Status> = None;
    let mut blocking = ArmingInhibits::NONE;
    let mut timing = TimingReport::default();
    let mut grip = GripReport::default();
    let mut depth = 0;
    let mut round = 0u32;
    loop {
        // A missed deadline of the flight level is logged at once, but only one per poll.
        if let Either::Second(()) = select(ticker.next(), links.timing.missed.wait()).await {
            timing.missed(links);
            ticker.next().await;
        }
        // One per round: the log's buffer is short.
        if let Some(look) = checks.get(round as usize) {
            silicon(look);
        }
        round = round.saturating_add(1);
        if let Some(status) = links.status.latest().map(|m| m.value)
            && shown != Some(status)
        {
            state(status, shown);
            if status.mode.rotors_stand() && shown.is_some_and(|before| !before.mode.rotors_stand()) {
                thrust(links);
            }
            shown = Some(status);
        }
        grip.look(links);
        hardware(links, &mut blocking);
        timing.second(links, round % SECOND);
        if round.is_multiple_of(SECOND) {
            stack(links, &mut depth);
        }
    }
}

/// Logs the stack's depth. By the first second every task has begun, which ends the depth of the start-up.
fn stack(links: &Links, logged: &mut u32) {
    let first = *logged == 0;
    if first {
        sophie_boards::stack::start_has_ended();
    }
    let used = sophie_boards::stack::stack_use();
    if used.is_scarce() {
        links.report_scarce_stack();
    }
    if first {
        silicon(&used.at_start());
    }
    if used.flight > *logged {
        *logged = used.flight;
        silicon(&used.in_flight());
    }
}

fn state(now: Status, before: Option<Status>) {
    match now.reason {
        None => defmt::info!("{=str}", now.mode.name()),
        Some(reason) => defmt::warn!("{=str}: {=str}", now.mode.name(), reason.text()),
    }
    if before.is_none_or(|b| b.warning != now.warning) && !now.warning.is_empty() {
        defmt::warn!("warning: {=str}", now.warning);
    }
}

/// Logs at the end of a flight what it has shown of the thrust.
fn thrust(links: &Links) {
    if let Some(factor) = links.thrust_factor.fresh() {
        defmt::info!("thrust {=f32} times the parameter's", factor.value);
    }
}

fn silicon(look: &ChipCheck) {
    let read = look.read.as_str();
    let ChipCheck { name, expected, .. } = look;
    if look.ok {
        defmt::info!(
            "silicon: {=str}: {=str}, expected {=str}: ok",
            name,
            read,
            expected
        );
    } else {
        defmt::warn!(
            "silicon: {=str}: {=str}, expected {=str}: not ok",
            name,
            read,
            expected
        );
    }
}

/// All hardware arming inhibits; the state's line has room for the first reason only.
fn hardware(links: &Links, shown: &mut ArmingInhibits) {
    let now = links.hardware();
    for reason in ArmingInhibit::ALL {
        match (shown.contains(reason), now.contains(reason)) {
            (false, true) => defmt::warn!("arming blocked: {=str}", reason.text()),
            (true, false) => defmt::info!("no longer blocked: {=str}", reason.text()),
            _ => {}
        }
    }
    *shown = now;
}
