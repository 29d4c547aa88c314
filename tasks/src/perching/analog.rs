//! Samples contact pressures at 500 Hz and the batteries in every fifth run, from one converter.
//!
//! A conversion must end before the next; messages carry the time of its beginning. A failing converter's links go
//! stale; after 100 ms arming is refused, and from the start if a sensor cannot read the grip pressure.

use core::pin::pin;

use embassy_futures::select::{Either, select};
use embassy_time::{Duration, Instant, Timer};
use sophie_control::arming::ArmingInhibit;
use sophie_control::battery::{Monitor, ServoMonitor, reading};
use sophie_control::gripper::contact_pressure::{Fsr, FsrScale};

use crate::deadline::FixedRate;
use crate::links::Links;
use crate::links::messages::Contact;
use crate::schedule::TaskId;
use crate::supervision::silence::SilenceWatch;
use sophie_ports::sensors::Analog;

/// Time without a conversion before a report.
pub const SILENCE: Duration = Duration::from_millis(100);
const BATTERY_EVERY: u8 = 5;

/// Samples the analog inputs; never returns.
pub async fn run(links: &Links, mut port: impl Analog) -> ! {
    let mut rate = FixedRate::of(links, TaskId::Analog);
    let scales = FsrScale::all(&links.params);
    for (scale, reason) in scales.iter().zip(ArmingInhibit::FSR_RANGE) {
        links.report(reason, !scale.reaches_grip(&links.params));
    }
    let mut sensors = scales.map(Sensor::new);
    let mut battery = Monitor::default();
    let mut servo_battery = ServoMonitor::default();
    let mut battery_dt = 0.0;
    let mut until_battery = BATTERY_EVERY;
    let mut sensor_dt = 0.0;
    let mut watch = SilenceWatch::new(ArmingInhibit::AnalogSilent, SILENCE, Instant::now());
    loop {
        let tick = rate.next().await;
        sensor_dt += tick.dt;
        battery_dt += tick.dt;
        let at = Instant::now();
        let conversion = {
            let mut conversion = pin!(port.read());
            match select(&mut conversion, Timer::at(watch.due())).await {
                Either::First(result) => result,
                Either::Second(()) => {
                    watch.look(links, Instant::now());
                    // A hung conversion holds its task; the supervisor detects that.
                    conversion.await
                }
            }
        };
        let Ok(frame) = conversion else {
            watch.look(links, at);
            continue;
        };
        watch.heard(links, at);

        let mut contact = Contact::default();
        for ((arm, sensor), counts) in contact.arms.iter_mut().zip(&mut sensors).zip(frame.fsr) {
            *arm = sensor.fsr.step(&sensor.scale, counts, sensor_dt);
        }
        sensor_dt = 0.0;
        links.contact.send(at, contact);

        until_battery -= 1;
        if until_battery > 0 {
            continue;
        }
        until_battery = BATTERY_EVERY;
        links.counts.send(at, frame);
        let (params, volts) = (&links.params, port.volts_per_count());
        let voltage = reading(frame.battery_voltage, volts * params.battery_divider);
        let current = reading(frame.battery_current, volts * params.battery_a_per_v);
        if let Some(measured) = battery.step(params, voltage, current, battery_dt) {
            links.battery.send(at, measured);
        }
        if params.servo_batt_div > 0.0 {
            let voltage = reading(frame.servo_battery, volts * params.servo_batt_div);
            if let Some(measured) = servo_battery.step(params, voltage, battery_dt) {
                links.servo_battery.send(at, measured);
            }
        }
        battery_dt = 0.0;
    }
}

struct Sensor {
    scale: FsrScale,
    fsr: Fsr,
}

impl Sensor {
    fn new(scale: FsrScale) -> Self {
        Self {
            scale,
            fsr: Fsr::default(),
        }
    }
}
