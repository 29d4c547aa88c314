//! `docs/pilot.md`: the switches, the numbers. `docs/display.md`: every mode, reason and arming check with what the pilot is to
//! do.
//!
//! A new text does not build before it is said here what to do about it.

extern crate std;
use std::fmt::Write;
use std::string::{String, ToString};
use std::vec::Vec;
use std::{format, fs};

use crate::arming::{ArmingInhibit, GESTURE_TIME, TILT_MAX};
use crate::contact::friction_limit::FrictionLimit;
use crate::gripper::grip_fault::GripFault;
use crate::maths::scalar::deg;
use crate::mode::*;
use crate::params::Params;
use crate::pilot::rc::{CHANNELS, RAW_CENTRE, RAW_HIGH, RAW_LOW, Sticks};
use crate::pilot::release_throttle::RELEASE_THROTTLE_MIN;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/pilot.md");

fn in_mode(mode: Mode) -> &'static str {
    match mode {
        Mode::Calibrating => "Stopped. Leave it alone until it says `DISARMED`.",
        Mode::Disarmed => "Stopped. The only mode in which to touch it.",
        Mode::Armed => "Rotors idle. Throttle up to fly.",
        Mode::Flight => "The sticks fly it.",
        Mode::Approach => "It looks for the pipe and comes down onto it by itself; any stick ends that.",
        Mode::Hold => "It stays where it is; the sticks move it, centred they stop it.",
        Mode::Contact => "It feels the pipe. Keep the throttle; climb or turn perch off to leave.",
        Mode::Clamping => "Arms close, then the rotors spool down. Wait.",
        Mode::Perched => "It holds; rotors stopped. Sticks do nothing.",
        Mode::Releasing => "Rotors carry, arms open. Keep the throttle.",
        Mode::Escaping => "It climbs off the pipe by itself. Throttle to hover.",
        Mode::Landed => "Keep the throttle low; it disarms by itself.",
        Mode::Failsafe => "It sinks, level. What it says beside the mode decides what you can do.",
    }
}

fn on_reason(reason: Reason) -> &'static str {
    match reason {
        Reason::Check(refusal) => on_inhibit(refusal),
        Reason::ArmFault(fault) => fault.map_or("", on_fault),
        Reason::KeepStill => "Hands off until it has calibrated.",
        Reason::ActuatorTest => "A builder tries a part at the console: hands off.",
        Reason::IdleTooLong => "Arm again; take off sooner.",
        Reason::BatteryCritical => "It lands: steer it over clear ground. On the pipe it stays: fetch it.",
        Reason::TippedOver => {
            "On its side, or turned faster than the gyro reads. Arm switch off; set it upright, look for damage."
        }
        Reason::PerchSwitchNotOff => "Perch off, then on.",
        Reason::HoldSwitchNotOff => "Hold off, then on.",
        Reason::NoPosition => "Fly on by hand; look at what measures the pose.",
        Reason::MotorsTooSlow => {
            "Fly and perch by hand: `motor_tau` is above 0.2 s. Measure it again, or fit other motors."
        }
        Reason::Swings => {
            "It goes on with slower loops; if it still swings, land. `motor_tau`, then [tuning](tuning.md)."
        }
        Reason::PositionStale => {
            "Steer by tilt, or hold off: it keeps only height and lean against the wind."
        }
        Reason::PositionLost => "Fly by hand; hold off.",
        Reason::NotOnCrown => "Climb; come down on top of the pipe.",
        Reason::SlidesOff => "Throttle to hover: it climbs away by itself. Try again.",
        Reason::NotTakenOver => "Throttle to hover ends the descent.",
        Reason::ClosingCancelled => "You turned perch off: throttle to hover.",
        Reason::ForceLimit => "Throttle to hover. Pipe or skin does not give the pressure: another spot.",
        Reason::PipeMisfit => "Throttle to hover. Is `pipe_diameter` this pipe's? Else another spot.",
        Reason::PipeOblique => "Throttle to hover; turn the nose along the pipe.",
        Reason::ArmsUneven => {
            "Throttle to hover; come down over the middle, where nothing is in an arm's way."
        }
        Reason::ArmsOpposed => "Throttle to hover; line up, come down over the middle.",
        Reason::LeansToStay => "Throttle to hover; come down nearer to the crown.",
        Reason::GripNotProven => "Throttle to hover; another spot.",
        Reason::GripLostSpooling => "Wait: the rotors carry again and it tries anew.",
        Reason::ClampSilent => "Do not let go: fetch it, read the log.",
        Reason::GripLost => "Let go and fly home, or fetch it.",
        Reason::PerchSwitchNotOn => "Perch on, then off.",
        Reason::ArmSwitchOff => "Arm switch on.",
        Reason::CrownLeft => "It stands beside the crown. If it slides off, come down further left.",
        Reason::CrownRight => "It stands beside the crown. If it slides off, come down further right.",
        Reason::TightensOnce => "Nothing yet: the arms press twice as hard.",
        Reason::TightensLast => "Be ready to let go.",
        Reason::Slips => "Let go and land again nearer the crown, or fetch it.",
        Reason::LeansTooFar => "It stays closed: fetch it by hand.",
        Reason::LiftsOff => "It lifts off by itself as the arms open: throttle to hover.",
        Reason::ThrottleTooHigh => "Less throttle.",
        Reason::SticksNotCentred => {
            "Perching by itself: roll, pitch and yaw centred, throttle in its middle."
        }
        Reason::ThrustUnknown => "Wait: a few seconds of flight show it, then it begins.",
        Reason::NoRange => {
            "The module below is silent, and no companion says where the pipe is. Hold off, and perch by hand."
        }
        Reason::TargetStale => {
            "It holds. Look after the companion that sends the pipe's place, or perch by hand."
        }
        Reason::TargetFar => {
            "It holds. Fly within a metre of the pipe and above it; then the companion's axes are wrong."
        }
        Reason::TargetJumps => "It climbs and tries again. If it comes back, perch by hand.",
        Reason::TakenOver => "It holds, or flies by hand if hold is off. Perch off, then on, to try again.",
        Reason::NoPipe => "Hold over the pipe, within a metre, nose along it; perch off, then on.",
        Reason::PipeTooShort => "Hold over another part of the pipe, 0.3 m from each end.",
        Reason::PipeLost | Reason::NotCentred | Reason::NotTouched => {
            "It climbs and tries again, five times in all; then it holds. Wait for less wind."
        }
        Reason::TouchedEarly => {
            "It climbs and tries again. If it comes back, the range is wrong: perch by hand."
        }
        Reason::RangeMisfit => {
            "It climbs and may try again once; then it holds. If it comes back, perch by hand."
        }
        Reason::RangeStale => "It holds. Look after the module below, or perch by hand.",
        Reason::ArmsStuck => "Keep the throttle, or perch on to hold again. Something holds the tendons.",
    }
}

fn on_fault(fault: GripFault) -> &'static str {
    match fault {
        GripFault::Stale => "Wait; if it stays, perch off. Look at the sensor's lead.",
        GripFault::Sensor => "Perch off, land. Sensor or lead is broken.",
        GripFault::Unfelt => "Perch off, land: the arm met something that its sensor does not feel.",
        GripFault::Ceiling => {
            "Perch off, land. Its pad has a divider ([wiring](wiring.md#pressure-sensors))."
        }
        GripFault::Tilt => "Wait; if it stays, perch off. Look at the arm's sensor.",
        GripFault::NotFinite => "Perch off, land, read the log.",
    }
}

fn on_inhibit(inhibit: ArmingInhibit) -> &'static str {
    match inhibit {
        ArmingInhibit::BrownOut => "Find out why the supply broke down; power off and on.",
        ArmingInhibit::BrownOutLevel => "Console: `brownout set`, once for each chip.",
        ArmingInhibit::Silicon => "Console: `silicon` marks it. Do not fly this board.",
        ArmingInhibit::Storing => "Wait a moment.",
        ArmingInhibit::Stored => "Restart: what is stored is not what would fly.",
        ArmingInhibit::StorageForeign => "Console: `list`, then `save`.",
        ArmingInhibit::StorageUnreadable => "Console: `list`, set what is lost, `save`.",
        ArmingInhibit::StorageFull => "Console: `reset` some parameters, `save`.",
        ArmingInhibit::MotorPulses => {
            "`motor_pulse_min` below `_idle` below `_max`, as your controllers have it ([wiring](wiring.md#motors))."
        }
        ArmingInhibit::ImuAbsent => "Power off and on; then the board is broken.",
        ArmingInhibit::ImuWrongPart => "This board's revision is not supported.",
        ArmingInhibit::ImuSelfTest => "Power off and on, at rest; then the part is broken.",
        ArmingInhibit::ImuCorrupt => "Land. Power off and on; then the part is broken.",
        ArmingInhibit::ImuLineSilent => "In the air it sinks while you steer: land. On the pipe it stays.",
        ArmingInhibit::RcLost => "Transmitter on? In the air it sinks; move roll or pitch to take it back.",
        ArmingInhibit::ImuStale => "Rotors have stopped. Power off and on; read the log.",
        ArmingInhibit::NotCalibrated => {
            "Leave it at rest, up to 90 s where its attitude is not that of gravity."
        }
        ArmingInhibit::SwitchOnAtPowerUp => "Arm switch off, then on.",
        ArmingInhibit::ThrottleNotLow => "Throttle down; trim it if it is.",
        ArmingInhibit::PerchSwitchOn => "Perch off.",
        ArmingInhibit::ArmsClosed => "Perch on and off: the arms open. Hands away.",
        ArmingInhibit::TiltTooLarge => "Set it upright.",
        ArmingInhibit::BatterySilent => {
            "The lead of the battery's voltage, or power by USB alone. In the air it lands: steer it. On the pipe it stays."
        }
        ArmingInhibit::BatteryLow => "Charge; or `battery_divider` is wrong.",
        ArmingInhibit::ServoBatterySilent => {
            "Its lead; or `servo_batt_div` 0 where it is not measured. On the pipe: let go."
        }
        ArmingInhibit::ServoBatteryLow => {
            "Charge it. In the air: no perch. On the pipe: let go now, while the servos can open the arms."
        }
        ArmingInhibit::ServoUnmarked => {
            "`calibrate servo 1` to `4` ([calibration](calibration.md#servos)), then `save`."
        }
        ArmingInhibit::AnalogSilent => "Power off and on; then the board is broken.",
        ArmingInhibit::FsrFault => "A chosen arm's sensor or its lead: look, or choose the other arms.",
        ArmingInhibit::FsrRange1
        | ArmingInhibit::FsrRange2
        | ArmingInhibit::FsrRange3
        | ArmingInhibit::FsrRange4 => {
            "Its pad has a divider: `fsr_scale_1` to `_4`, `fsr_divider` ([wiring](wiring.md#pressure-sensors))."
        }
        ArmingInhibit::ArmSensor1
        | ArmingInhibit::ArmSensor2
        | ArmingInhibit::ArmSensor3
        | ArmingInhibit::ArmSensor4 => "Its cable, its address ([wiring](wiring.md#arm-sensors)).",
        ArmingInhibit::Overruns => "Restart; if it comes back, `timing` and the log.",
    }
}

/// A row for each text, with rows that say the same joined.
fn table(head: &str, rows: impl IntoIterator<Item = (String, &'static str)>) -> String {
    let mut joined = Vec::<(String, &str)>::new();
    for (text, to_do) in rows {
        match joined.last_mut() {
            Some((texts, before)) if *before == to_do => {
                texts.push_str("; ");
                texts.push_str(&text);
            }
            _ => joined.push((text, to_do)),
        }
    }
    let mut table = format!("| {head} | what to do |\n|---|---|\n");
    for (text, to_do) in joined {
        writeln!(table, "| {text} | {to_do} |").unwrap();
    }
    table
}

/// What channel `number` (from 1) means in its low, middle and high position.
fn positions(number: usize, said: impl Fn(Sticks) -> String) -> String {
    let at = |raw| {
        let mut channels = [RAW_CENTRE; CHANNELS];
        channels[number - 1] = raw;
        said(Sticks::from_channels(&channels).unwrap())
    };
    [RAW_LOW, RAW_CENTRE, RAW_HIGH].map(at).join(" | ")
}

fn channels() -> String {
    let on = |on: bool| if on { "**on**" } else { "off" }.to_string();
    let way = |value: f32, low: &str, high: &str| match value {
        v if v < 0.0 => low.to_string(),
        v if v > 0.0 => high.to_string(),
        _ => "0".to_string(),
    };
    let share = |value: f32| format!("{:.0} %", value * 100.0);
    let word = |debug: String| debug.to_lowercase();
    let rows = [
        ("roll", positions(1, |s| way(s.roll, "left", "right"))),
        (
            "pitch",
            positions(2, |s| way(s.pitch, "nose down (pushed)", "nose up (pulled)")),
        ),
        ("throttle", positions(3, |s| share(s.throttle))),
        ("yaw", positions(4, |s| way(s.yaw, "nose left", "nose right"))),
        ("arm switch", positions(5, |s| on(s.arm_switch))),
        (
            "stick mode",
            positions(6, |s| word(format!("{:?}", s.stick_mode))),
        ),
        ("perch switch", positions(7, |s| on(s.perch_switch))),
        ("arms that close", positions(8, |s| word(format!("{:?}", s.arms)))),
        ("hold switch", positions(9, |s| on(s.hold_switch))),
    ];
    let mut table = String::from(
        "| channel | what | low, 988 µs | middle, 1500 µs | high, 2012 µs |\n|---:|---|---|---|---|\n",
    );
    for (number, (what, positions)) in (1..).zip(rows) {
        writeln!(table, "| {number} | {what} | {positions} |").unwrap();
    }
    table
}

fn quoted(text: &str) -> String {
    text.to_string()
}

/// What the page says in numbers, as the code has them.
fn numbers() -> [String; 14] {
    let p = Params::DEFAULT;
    let percent = |share: f32| format!("{:.0} %", share * 100.0);
    let degrees = |angle: f32| format!("{:.0}°", angle.to_degrees());
    let most = percent(p.perch_thr_max);
    let friction_limit = FrictionLimit::from_params(&p);
    let level = (0..90)
        .take_while(|&lean| friction_limit.holds(deg(lean as f32), p.perch_lift))
        .count();
    let least = percent(RELEASE_THROTTLE_MIN);
    [
        format!("yaw full right, for {GESTURE_TIME:.0} s"),
        format!("leans less than {}", degrees(TILT_MAX)),
        format!("idle for at most {:.0} s", states::armed::IDLE_MAX),
        format!("disarms by itself {:.0} s after", states::landed::LANDED_TIME),
        format!("throttle at or below {most}"),
        format!("within {} of level", degrees(deg(level as f32 - 1.0))),
        format!("After {} s the arms close", states::contact::CONTACT_TIME),
        format!("at most {:.0} s", p.clamp_timeout),
        format!("between {least} and {most}"),
        format!(
            "take the throttle over within {:.0} s",
            states::escaping::TAKE_OVER_TIME
        ),
        format!("less than {:.0} s", states::failsafe::RESUME_TIME),
        format!(
            "more than {} of their travel",
            percent(states::failsafe::RESUME_STICK)
        ),
        format!("below {} V", p.battery_warning),
        format!("below {} V under load", p.battery_critical),
    ]
}

#[test]
fn the_pilots_pages_have_every_switch_and_text_and_what_to_do() {
    let faults = [
        GripFault::Stale,
        GripFault::Sensor,
        GripFault::Unfelt,
        GripFault::Ceiling,
        GripFault::Tilt,
        GripFault::NotFinite,
    ];
    let parts = [
        (
            "modes",
            table("mode", Mode::ALL.map(|m| (format!("`{}`", m.name()), in_mode(m)))),
        ),
        (
            "reasons",
            table(
                "it says",
                Reason::PLAIN.iter().map(|r| (quoted(r.text()), on_reason(*r))),
            ),
        ),
        (
            "faults",
            table("an arm says", faults.map(|f| (quoted(f.text()), on_fault(f)))),
        ),
        (
            "checks",
            table(
                "arming refused",
                ArmingInhibit::ALL.map(|r| (quoted(r.text()), on_inhibit(r))),
            ),
        ),
    ];
    let test = "--package sophie-control mode::tests::pilot_page";
    sophie_pages::hold("pilot", &[("channels", channels())], test);
    sophie_pages::hold("display", &parts, test);
}

#[test]
fn the_numbers_of_the_pilots_page_are_those_of_the_code() {
    let page = fs::read_to_string(PAGE).unwrap();
    let page: Vec<_> = page.split_whitespace().collect();
    let page = page.join(" ");
    for number in numbers() {
        assert!(page.contains(&number), "docs/pilot.md does not say '{number}'");
    }
}
