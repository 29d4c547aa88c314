//! Self-test of all parts without motion: a table of result, measured value and allowed range.

use core::fmt;

use embassy_time::{Duration, Timer};
use sophie_control::arming::ArmingInhibit;
use sophie_control::gripper::contact_pressure::FsrFault;
use sophie_control::maths::scalar::to_deg;

use super::Console;
use crate::schedule::{Level, TaskId};
use sophie_control::maths::decimal::Decimal;
use sophie_ports::chip::Chip;
use sophie_ports::serial::{SerialInput, SerialOutput};
use sophie_ports::storage::Storage;

/// Time over which rates are counted.
const TIME: Duration = Duration::from_secs(1);
/// Allowed accelerometer norm at rest, m/s²: gravity and a bias of about 40 mg.
const GRAVITY: [f32; 2] = [9.4, 10.2];
/// Fastest turn that counts as rest, deg/s.
const RATE_MAX: f32 = 3.0;
/// Largest tilt of an arm at rest that its sensor may give, deg.
const TILT_MAX: f32 = 60.0;
/// Share of the declared rate that must be reached, %.
const RATE_SHARE: u32 = 95;
/// Allowed deadline misses of the flight level in that time.
const MISSED_MAX: u32 = 10;

const STORAGE: &[ArmingInhibit] = &[
    ArmingInhibit::StorageForeign,
    ArmingInhibit::StorageUnreadable,
    ArmingInhibit::StorageFull,
];
const CHIP: &[ArmingInhibit] = &[
    ArmingInhibit::BrownOut,
    ArmingInhibit::BrownOutLevel,
    ArmingInhibit::Silicon,
];
const IMU: &[ArmingInhibit] = &[
    ArmingInhibit::ImuAbsent,
    ArmingInhibit::ImuWrongPart,
    ArmingInhibit::ImuSelfTest,
    ArmingInhibit::ImuCorrupt,
    ArmingInhibit::ImuLineSilent,
];

const PRESSURE_SENSORS: [&str; 4] = [
    "pressure sensor 1",
    "pressure sensor 2",
    "pressure sensor 3",
    "pressure sensor 4",
];
const ARM_SENSORS: [&str; 4] = ["arm sensor 1", "arm sensor 2", "arm sensor 3", "arm sensor 4"];

/// Count of tests, and of failures.
#[derive(Default)]
struct Tally {
    all: u8,
    failed: u8,
}

/// Counters of runs and misses for the rate test.
struct Counted {
    motors: u32,
    servos: u32,
    missed: u32,
}

impl<I: SerialInput, O: SerialOutput, S: Storage, C: Chip> Console<'_, I, O, S, C> {
    /// Runs all tests that need no motion.
    pub(super) async fn selftest(&mut self) {
        if let Err(why) = self.stopped() {
            return self.refuse("not tested", why).await;
        }
        let before = self.counted();
        Timer::after(TIME).await;
        let now = self.counted();
        let mut tally = Tally::default();
        self.reported(&mut tally, "stored parameters", STORAGE).await;
        self.reported(&mut tally, "chip", CHIP).await;
        self.inertial(&mut tally).await;
        self.radio_and_battery(&mut tally).await;
        self.arms(&mut tally).await;
        let rate = |name, runs: u32, least: u32| (name, runs, least * RATE_SHARE / 100);
        let servos = self.links.params.servo_frame_rate as u32;
        for (name, runs, least) in [
            rate("servo frames", now.servos.wrapping_sub(before.servos), servos),
            rate("motor frames", now.motors.wrapping_sub(before.motors), 1000),
        ] {
            let found = format_args!("{runs} a second ({least} at least)");
            self.test(&mut tally, name, runs >= least, found).await;
        }
        let missed = now.missed.wrapping_sub(before.missed);
        let found = format_args!("{missed} missed ({MISSED_MAX} at most)");
        self.test(&mut tally, "deadlines", missed <= MISSED_MAX, found)
            .await;
        let Tally { all, failed } = tally;
        match failed {
            0 => self.out.line(format_args!("all {all} passed")).await,
            _ => self.out.line(format_args!("{failed} of {all} failed")).await,
        }
    }

    fn counted(&self) -> Counted {
        let flight = TaskId::ALL
            .into_iter()
            .filter(|task| task.level() == Level::Flight);
        Counted {
            motors: self.links.timing.task(TaskId::Motors).runs,
            servos: self.links.timing.task(TaskId::Servos).runs,
            missed: flight.fold(0, |n, task| n.wrapping_add(self.links.timing.task(task).overruns)),
        }
    }

    async fn test(&mut self, tally: &mut Tally, name: &str, ok: bool, found: fmt::Arguments<'_>) {
        tally.all += 1;
        tally.failed += u8::from(!ok);
        let verdict = if ok { "pass" } else { "FAIL" };
        self.out.line(format_args!("{verdict}  {name:18} {found}")).await;
    }

    /// First reported reason among `reasons`.
    fn first_of(&self, reasons: &[ArmingInhibit]) -> Option<&'static str> {
        let hardware = self.links.hardware();
        let mut held = reasons.iter().filter(|reason| hardware.contains(**reason));
        held.next().map(|reason| reason.text())
    }

    /// Tests a part by its reported arming inhibits alone.
    async fn reported(&mut self, tally: &mut Tally, name: &str, reasons: &[ArmingInhibit]) {
        let found = self.first_of(reasons);
        let text = found.unwrap_or("nothing reported");
        self.test(tally, name, found.is_none(), format_args!("{text}"))
            .await;
    }

    async fn inertial(&mut self, tally: &mut Tally) {
        let name = "inertial sensor";
        if let Some(why) = self.first_of(IMU) {
            return self.test(tally, name, false, format_args!("{why}")).await;
        }
        let Some(a) = self.links.attitude.fresh() else {
            return self.test(tally, name, false, format_args!("silent")).await;
        };
        let (force, turn) = (a.accel.norm(), to_deg(a.rate.norm()));
        let [least, most] = GRAVITY;
        let still = (least..=most).contains(&force) && turn <= RATE_MAX;
        let [force, turn, least, most, fastest] = [force, turn, least, most, RATE_MAX].map(Decimal);
        let found = format_args!("{force:.2} m/s2 ({least} to {most}), {turn:.1} deg/s ({fastest} at most)");
        self.test(tally, name, still, found).await;
        let bias = Decimal(to_deg(a.gyro_bias.norm()));
        let found = format_args!(
            "bias {bias:.2} deg/s{}",
            if a.calibrated {
                ""
            } else {
                ", not calibrated: keep still"
            }
        );
        self.test(tally, "gyro", a.calibrated, found).await;
    }

    async fn radio_and_battery(&mut self, tally: &mut Tally) {
        let rc = self.links.rc.fresh();
        let (frames, errors) = rc.map_or((0, 0), |rc| (rc.frames, rc.errors));
        let silent = if rc.is_some() { "" } else { "silent: " };
        let found = format_args!("{silent}{frames} frames, {errors} errors");
        self.test(tally, "receiver", rc.is_some(), found).await;
        let volts = self.links.battery.fresh().map_or(0.0, |battery| battery.voltage);
        let least = self.links.params.battery_warning;
        let (shown, warning) = (Decimal(volts), Decimal(least));
        let found = format_args!("{shown:.2} V ({warning} at least)");
        self.test(tally, "battery", volts >= least, found).await;
    }

    async fn arms(&mut self, tally: &mut Tally) {
        let contact = self.links.contact.fresh().map(|contact| contact.arms.map(Some));
        let pressures = contact.unwrap_or([None; 4]);
        let ranges = ArmingInhibit::FSR_RANGE.map(|range| self.first_of(&[range]).is_some());
        for ((name, reading), short) in PRESSURE_SENSORS.into_iter().zip(pressures).zip(ranges) {
            self.pressure(tally, name, reading, short).await;
        }
        for (name, tilt) in ARM_SENSORS.into_iter().zip(self.links.tilts().values()) {
            let Some(tilt) = tilt.map(to_deg) else {
                self.test(tally, name, false, format_args!("silent")).await;
                continue;
            };
            let (shown, most) = (Decimal(tilt), Decimal(TILT_MAX));
            let found = format_args!("tilt {shown:.1} deg ({most} at most)");
            self.test(tally, name, tilt.abs() <= TILT_MAX, found).await;
        }
    }

    /// Tests the pressure sensors: an open arm must read no contact.
    async fn pressure(
        &mut self,
        tally: &mut Tally,
        name: &str,
        reading: Option<Result<f32, FsrFault>>,
        short_of_grip: bool,
    ) {
        let most = self.links.params.release_pressure;
        let fault = match reading {
            _ if short_of_grip => "range too small",
            None => "silent",
            Some(Err(FsrFault::Short)) => "shorted",
            Some(Err(FsrFault::Converter)) => "converter out of range",
            Some(Ok(pressure)) => {
                let (shown, limit) = (Decimal(pressure), Decimal(most));
                let found = format_args!("{shown:.0} Pa ({limit} at most with open arms)");
                return self.test(tally, name, pressure <= most, found).await;
            }
        };
        self.test(tally, name, false, format_args!("{fault}")).await;
    }
}
