//! Self-test of all parts without motion, row by row: measured value and allowed range.

use core::fmt::{self, Write};

use embassy_time::{Duration, Instant};
use heapless::String;
use sophie_control::arming::ArmingInhibit;
use sophie_control::gripper::contact_pressure::FsrFault;
use sophie_control::maths::decimal::Decimal;
use sophie_control::maths::scalar::to_deg;
use sophie_mavlink::Row;

use crate::links::Links;
use crate::schedule::{Level, TaskId};

/// Time over which rates are counted.
pub const TIME: Duration = Duration::from_secs(1);
/// Number of rows.
pub const ROWS: u8 = 17;
/// Allowed accelerometer norm at rest, m/s²: gravity and a bias of about 40 mg.
const GRAVITY: [f32; 2] = [9.4, 10.2];
/// Fastest turn that counts as rest, deg/s.
const RATE_MAX: f32 = 3.0;
/// Largest tilt of an arm at rest that its sensor may give, deg.
const TILT_MAX: f32 = 60.0;
/// Share of the declared rate that must be reached, %.
const RATE_SHARE: u32 = 95;
/// Declared rate of the motor frames, Hz.
const MOTOR_RATE: u32 = 1000;
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

/// Runs and misses so far.
#[derive(Clone, Copy, Debug)]
struct Counts {
    motors: u32,
    servos: u32,
    missed: u32,
}

/// A running self-test.
#[derive(Clone, Copy, Debug)]
pub struct SelfTest {
    begun: Instant,
    before: Counts,
    /// Counted within [`TIME`]; `None` until then.
    counted: Option<Counts>,
}

impl SelfTest {
    /// Begins to count.
    pub fn begin(links: &Links) -> Self {
        Self {
            begun: Instant::now(),
            before: Counts::of(links),
            counted: None,
        }
    }

    /// True once the rates are counted, [`TIME`] after the begin.
    pub fn is_ready(&mut self, links: &Links) -> bool {
        if self.counted.is_none() && self.begun.elapsed() >= TIME {
            let now = Counts::of(links);
            self.counted = Some(Counts {
                motors: now.motors.wrapping_sub(self.before.motors),
                servos: now.servos.wrapping_sub(self.before.servos),
                missed: now.missed.wrapping_sub(self.before.missed),
            });
        }
        self.counted.is_some()
    }

    /// Row `number`, below [`ROWS`]; `None` before the rates are counted, and beyond the last.
    pub fn row(&self, links: &Links, number: u8) -> Option<Row> {
        let counts = self.counted?;
        let at = |first: u8| usize::from(number - first);
        Some(match number {
            0 => reported(links, "stored parameters", STORAGE),
            1 => reported(links, "chip", CHIP),
            2 => inertial(links),
            3 => gyro(links),
            4 => receiver(links),
            5 => battery(links),
            6..=9 => pressure(links, at(6))?,
            10..=13 => arm(links, at(10))?,
            14 => {
                let rate = links.params.servo_frame_rate as u32;
                rated("servo frames", counts.servos, rate)
            }
            15 => rated("motor frames", counts.motors, MOTOR_RATE),
            16 => {
                let missed = counts.missed;
                let found = format_args!("{missed} missed ({MISSED_MAX} at most)");
                row("deadlines", missed <= MISSED_MAX, &[], found)
            }
            _ => return None,
        })
    }
}

impl Counts {
    fn of(links: &Links) -> Self {
        let flight = TaskId::ALL
            .into_iter()
            .filter(|task| task.level() == Level::Flight);
        Self {
            motors: links.timing.task(TaskId::Motors).runs,
            servos: links.timing.task(TaskId::Servos).runs,
            missed: flight.fold(0, |n, task| n.wrapping_add(links.timing.task(task).overruns)),
        }
    }
}

fn row(name: &'static str, passed: bool, inhibits: &[ArmingInhibit], text: fmt::Arguments<'_>) -> Row {
    let mut found = String::new();
    let _ = found.write_fmt(text);
    Row {
        name,
        passed,
        inhibits: inhibits.iter().copied().collect(),
        found,
    }
}

/// First reported reason among `reasons`.
fn first_of(links: &Links, reasons: &[ArmingInhibit]) -> Option<&'static str> {
    let hardware = links.hardware();
    let mut held = reasons.iter().filter(|reason| hardware.contains(**reason));
    held.next().map(|reason| reason.text())
}

/// A part that is judged by its reported arming inhibits alone.
fn reported(links: &Links, name: &'static str, reasons: &[ArmingInhibit]) -> Row {
    let found = first_of(links, reasons);
    let text = found.unwrap_or("nothing reported");
    row(name, found.is_none(), reasons, format_args!("{text}"))
}

fn rated(name: &'static str, runs: u32, rate: u32) -> Row {
    let least = rate * RATE_SHARE / 100;
    row(
        name,
        runs >= least,
        &[],
        format_args!("{runs} a second ({least} at least)"),
    )
}

fn inertial(links: &Links) -> Row {
    let name = "inertial sensor";
    if let Some(why) = first_of(links, IMU) {
        return row(name, false, IMU, format_args!("{why}"));
    }
    let Some(a) = links.attitude.fresh() else {
        return row(name, false, IMU, format_args!("silent"));
    };
    let (force, turn) = (a.accel.norm(), to_deg(a.rate.norm()));
    let [least, most] = GRAVITY;
    let still = (least..=most).contains(&force) && turn <= RATE_MAX;
    let [force, turn, least, most, fastest] = [force, turn, least, most, RATE_MAX].map(Decimal);
    let found = format_args!("{force:.2} m/s2 ({least} to {most}), {turn:.1} deg/s ({fastest} at most)");
    row(name, still, IMU, found)
}

fn gyro(links: &Links) -> Row {
    let inhibits = &[ArmingInhibit::NotCalibrated];
    let Some(a) = links.attitude.fresh() else {
        return row("gyro", false, inhibits, format_args!("silent"));
    };
    let bias = Decimal(to_deg(a.gyro_bias.norm()));
    let state = if a.calibrated {
        ""
    } else {
        ", not calibrated: keep still"
    };
    row(
        "gyro",
        a.calibrated,
        inhibits,
        format_args!("bias {bias:.2} deg/s{state}"),
    )
}

fn receiver(links: &Links) -> Row {
    let rc = links.rc.fresh();
    let (frames, errors) = rc.map_or((0, 0), |rc| (rc.frames, rc.errors));
    let silent = if rc.is_some() { "" } else { "silent: " };
    let found = format_args!("{silent}{frames} frames, {errors} errors");
    row("receiver", rc.is_some(), &[ArmingInhibit::RcLost], found)
}

fn battery(links: &Links) -> Row {
    let volts = links.battery.fresh().map_or(0.0, |battery| battery.voltage);
    let least = links.params.battery_warning;
    let (shown, warning) = (Decimal(volts), Decimal(least));
    let inhibits = &[ArmingInhibit::BatterySilent, ArmingInhibit::BatteryLow];
    let found = format_args!("{shown:.2} V ({warning} at least)");
    row("battery", volts >= least, inhibits, found)
}

/// An open arm must read no contact.
fn pressure(links: &Links, arm: usize) -> Option<Row> {
    let name = *PRESSURE_SENSORS.get(arm)?;
    let short_of_grip = *ArmingInhibit::FSR_RANGE.get(arm)?;
    let inhibits = &[ArmingInhibit::FsrFault, short_of_grip];
    let most = links.params.release_pressure;
    let reading = links
        .contact
        .fresh()
        .and_then(|contact| contact.arms.get(arm).copied());
    let fault = match reading {
        _ if links.hardware().contains(short_of_grip) => "range too small",
        None => "silent",
        Some(Err(FsrFault::Short)) => "shorted",
        Some(Err(FsrFault::Converter)) => "converter out of range",
        Some(Ok(pressure)) => {
            let (shown, limit) = (Decimal(pressure), Decimal(most));
            let found = format_args!("{shown:.0} Pa ({limit} at most with open arms)");
            return Some(row(name, pressure <= most, inhibits, found));
        }
    };
    Some(row(name, false, inhibits, format_args!("{fault}")))
}

fn arm(links: &Links, arm: usize) -> Option<Row> {
    let name = *ARM_SENSORS.get(arm)?;
    let Some(tilt) = links.tilts().values().get(arm).copied()?.map(to_deg) else {
        return Some(row(name, false, &[], format_args!("silent")));
    };
    let (shown, most) = (Decimal(tilt), Decimal(TILT_MAX));
    let found = format_args!("tilt {shown:.1} deg ({most} at most)");
    Some(row(name, tilt.abs() <= TILT_MAX, &[], found))
}
