//! Status report of the vehicle.

use embassy_time::Instant;
use sophie_control::mode::{Mode, Reason};

use super::Console;
use crate::schedule::TaskId;
use sophie_control::maths::decimal::Decimal;
use sophie_control::vibration::MARK;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    pub(super) async fn status(&mut self) {
        match self.links.status.fresh() {
            None => self.out.line(format_args!("the commander is silent")).await,
            Some(status) => {
                let colon = if status.reason.is_none() { "" } else { ": " };
                let (mode, reason) = (status.mode.name(), status.reason.map_or("", Reason::text));
                self.out.line(format_args!("{mode}{colon}{reason}")).await;
                if !status.warning.is_empty() {
                    self.out.line(format_args!("warning: {}", status.warning)).await;
                }
                if status.mode == Mode::Disarmed && status.inhibits.is_empty() {
                    self.out.line(format_args!("nothing forbids arming")).await;
                }
                for inhibit in status.inhibits.iter() {
                    self.out
                        .line(format_args!("arming refused: {}", inhibit.text()))
                        .await;
                }
            }
        }
        match self.links.battery.fresh() {
            Some(b) => {
                // Unknown values are shown as -1. Converts A·s to mAh.
                let known =
                    [b.current, b.used.map(|used| used / 3.6)].map(|value| Decimal(value.unwrap_or(-1.0)));
                let (volts, [amps, used]) = (Decimal(b.voltage), known);
                self.out
                    .line(format_args!(
                        "battery {volts:.2} V, {amps:.1} A, {used:.0} mAh used"
                    ))
                    .await;
            }
            None => self.out.line(format_args!("battery not measured")).await,
        }
        if let Some(b) = self.links.servo_battery.fresh() {
            let volts = Decimal(b.voltage);
            self.out.line(format_args!("servo battery {volts:.2} V")).await;
        }
        match self.links.rc.latest() {
            Some(rc) => {
                let heard = if rc.fresh(self.links.rc.stale_after).is_some() {
                    ""
                } else {
                    ", silent now"
                };
                let (frames, errors) = (rc.value.frames, rc.value.errors);
                self.out
                    .line(format_args!("receiver {frames} frames, {errors} errors{heard}"))
                    .await;
            }
            None => {
                self.out
                    .line(format_args!("receiver silent since the start"))
                    .await
            }
        }
        if let Some(vibration) = self.links.vibration.fresh() {
            let [x, y, z] = vibration.rms.to_array().map(Decimal);
            let (most, clipped) = (Decimal(MARK), vibration.clipped);
            self.out
                .line(format_args!(
                    "vibration {x:.1} {y:.1} {z:.1} m/s2 ({most} at most in flight), {clipped} readings clipped"
                ))
                .await;
        }
        let up = Instant::now().as_secs();
        let (hours, minutes, seconds) = (up / 3600, up / 60 % 60, up % 60);
        self.out
            .line(format_args!("up for {hours}:{minutes:02}:{seconds:02}"))
            .await;
        match self.changed() {
            0 => (),
            1 => self.out.line(format_args!("1 change is not saved")).await,
            n => self.out.line(format_args!("{n} changes are not saved")).await,
        }
    }

    pub(super) async fn timing(&mut self) {
        self.out
            .line(format_args!(
                "            runs/s  worst us: late  response execution  overruns"
            ))
            .await;
        // In milliseconds and at least 1, to avoid a division by zero just after the start.
        let up = Instant::now().as_millis().max(1);
        // After the tasks the chain from contact pressure to servo pulse: late at the command, response at the pulse.
        let chain = [("contact", self.links.timing.contact())];
        let tasks = TaskId::ALL.map(|task| (task.name(), self.links.timing.task(task)));
        for (name, t) in tasks.into_iter().chain(chain) {
            let rate = u64::from(t.runs) * 1000 / up;
            self.out
                .line(format_args!(
                    "{name:11} {rate:>6} {:>15} {:>9} {:>9} {:>9}",
                    t.worst_lateness_us, t.worst_response_us, t.worst_execution_us, t.overruns
                ))
                .await;
        }
    }
}
