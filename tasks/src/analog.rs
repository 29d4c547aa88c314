//! Contact pressures and the battery, from the same converter.
//!
//! Steady level. Pressures at 500 Hz, the battery at every fifth conversion; a conversion must be over before
//! the next. Messages carry the time at which the conversion was begun, however long it takes. A converter that fails publishes nothing: its links go stale, and their readers know what to do.
//! After 100 ms without a conversion it is reported against arming, and from the start on a sensor that cannot read
//! the grip pressure.

use core::pin::pin;

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use sophie_control::arming::Refusal;
use sophie_control::battery::Monitor;
use sophie_control::fsr::{Fsr, FsrScale};

use crate::deadline::{FixedRate, TaskId};
use crate::links::{Contact, Links};
use crate::ports::Analog;

/// Time without a conversion after which the inputs count as silent.
pub const SILENCE: Duration = Duration::from_millis(100);
/// Conversions for one battery reading.
const BATTERY_EVERY: u8 = 5;

/// Serves the analog inputs; never returns.
pub async fn run(links: &Links, mut port: impl Analog) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Analog);
    let scales = FsrScale::all(&links.params);
    for (scale, reason) in scales.iter().zip(Refusal::FSR_RANGE) {
        links.report(reason, !scale.reaches_grip(&links.params));
    }
    let mut sensors = [Fsr::default(); 4];
    let mut battery = Monitor::default();
    let mut battery_dt = 0.0;
    let mut until_battery = BATTERY_EVERY;
    let mut sensor_dt = 0.0;
    let mut last_good = Instant::now();
    let mut silent = false;
    loop {
        let tick = rate.next().await;
        sensor_dt += tick.dt;
        battery_dt += tick.dt;
        let at = Instant::now();
        let conversion = {
            let mut conversion = pin!(port.read());
            match select(&mut conversion, Timer::at(last_good + SILENCE)).await {
                Either::First(result) => result,
                Either::Second(()) => {
                    watch(links, &mut silent, true);
                    // A converter that never ends holds its task: the supervisor sees to that.
                    conversion.await
                }
            }
        };
        let Ok(frame) = conversion else {
            watch(
                links,
                &mut silent,
                at.saturating_duration_since(last_good) >= SILENCE,
            );
            continue;
        };
        last_good = at;
        watch(links, &mut silent, false);

        let mut contact = Contact::default();
        let slots = contact.pressure.iter_mut().zip(contact.fault.iter_mut());
        let readings = sensors.iter_mut().zip(&scales).zip(frame.fsr);
        for (((sensor, scale), counts), (pressure, fault)) in readings.zip(slots) {
            match sensor.step(scale, counts, sensor_dt) {
                Ok(p) => *pressure = p,
                Err(_) => *fault = true,
            }
        }
        sensor_dt = 0.0;
        links.contact.send(at, contact);

        until_battery -= 1;
        if until_battery > 0 {
            continue;
        }
        until_battery = BATTERY_EVERY;
        let (params, volts) = (&links.params, port.volts_per_count());
        let voltage = f32::from(frame.battery_voltage) * (volts * params.battery_divider);
        let current = f32::from(frame.battery_current) * (volts * params.battery_a_per_v);
        if let Some(measured) = battery.step(params, voltage, current, battery_dt) {
            links.battery.send(at, measured);
        }
        battery_dt = 0.0;
    }
}

/// Reports silence when it begins and when it ends.
fn watch(links: &Links, known: &mut bool, silent: bool) {
    if *known != silent {
        *known = silent;
        links.report(Refusal::AnalogSilent, silent);
    }
}
