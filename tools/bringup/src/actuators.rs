//! Steps that turn something: tendon servos, motor controllers, rotors.

use std::time::{Duration, Instant};

use sophie_control::allocation::motor_pulses::{MotorPulses, by_pulses};
use sophie_control::allocation::wrench::PerArm;
use sophie_control::calibration::step::Calibration;
use sophie_control::gripper::tendon::Reel;
use sophie_control::params::{MotorMap, Params};
use sophie_control::pilot::actuator_test::{
    PLACE_TIME, PULSE_MAX_US, PULSE_MIN_US, SPIN_DRIVE, SPIN_DRIVE_MAX, SPIN_TIME,
};
use sophie_dialect::{MavCmd, MotorTestThrottleType};

use super::walk::{Measured, Stop, Verdict, Walk};
use super::{Judged, Step};

/// Step of a servo and of a motor's pulse, µs: 1.4 degrees of a servo.
const STEP_US: f32 = 10.0;
/// First pulse of a motor above its stop, µs: less than any dead zone, and the least drive that the bench takes.
const FIRST_US: f32 = 30.0;
/// Initial pulse of a servo without calibrated marks, µs: mid-travel of every servo, far from its end stops.
const MIDDLE_US: f32 = 1500.0;
/// Number of the first tendon servo among the outputs.
pub(super) const FIRST_SERVO: usize = 5;
/// Most steps in one reply: what moves a servo over its whole range.
const MOST_STEPS: i32 = 200;

/// Position of each rotor, and whether it turns clockwise seen from above.
const ROTORS: [(&str, bool); 4] = [
    ("front-left", false),
    ("rear-left", true),
    ("front-right", true),
    ("rear-right", false),
];

/// The builder's answer about one output.
#[derive(Clone, Copy)]
struct Seen {
    /// Rotor that turned, 0 to 3; `None` for none.
    rotor: Option<usize>,
    clockwise: bool,
}

pub(super) fn servo(walk: &mut Walk<'_>, step: &Step) -> Judged {
    walk.ready()?;
    let servo = step.number - 1;
    let params = walk.vehicle.values()?.params();
    let reel = Reel::from_params(&params, servo);
    let marked = params.servo_marks.has(servo);
    let marks = marked.then(|| [reel.pulse(0.0), reel.pulse(params.servo_range)]);
    let before = walk.before(Calibration::Servo, servo)?;
    let mut pulses = [MIDDLE_US; 2];
    let mut from = MIDDLE_US;
    for (at, name) in ["release", "full"].into_iter().enumerate() {
        let begin = marks.and_then(|marks| marks.get(at).copied()).unwrap_or(from);
        walk.say(&format!("  | {name} mark of servo {}", step.number));
        match move_servo(walk, servo, begin)? {
            Ok(pulse) => {
                from = pulse;
                if let Some(slot) = pulses.get_mut(at) {
                    *slot = pulse;
                }
            }
            Err(refused) => {
                give_back(walk, servo)?;
                return Ok(Verdict::of(false, vec![refused]));
            }
        }
    }
    give_back(walk, servo)?;
    match walk.measure(Calibration::Servo, step.number, 1, pulses)? {
        Measured::Bad(line) => Ok(Verdict::of(false, vec![line])),
        Measured::Good(_) => {
            let figures = walk.note_changes(Calibration::Servo, servo, &before)?;
            let mut verdict = Verdict::of(true, figures);
            verdict.parameters = walk.keep()?;
            Ok(verdict)
        }
    }
}

/// Back to the release mark, or without a pulse.
pub(super) fn give_back(walk: &mut Walk<'_>, servo: usize) -> Result<(), Stop> {
    let output = (FIRST_SERVO + servo) as f32;
    walk.order(MavCmd::MAV_CMD_DO_SET_SERVO, &[output, 0.0])
        .map(|_| ())
}

/// Moves the servo by the builder's `+`, `-`, `+12` until Enter takes its pulse; the vehicle's reason if it refuses.
fn move_servo(walk: &mut Walk<'_>, servo: usize, mut pulse: f32) -> Result<Result<f32, String>, Stop> {
    let output = (FIRST_SERVO + servo) as f32;
    let held = Duration::from_secs_f32(PLACE_TIME);
    loop {
        if let Some(refused) = walk.order(MavCmd::MAV_CMD_DO_SET_SERVO, &[output, pulse])? {
            return Ok(Err(refused));
        }
        let placed = Instant::now();
        walk.user.live(&format!("  | {pulse:.0} us"));
        let steps = loop {
            let reply = walk.ask("+ or - moves it by 10 us (+9: nine times), Enter takes it:")?;
            if reply.is_empty() {
                break 0;
            }
            if let Some(steps) = moves(&reply) {
                break steps;
            }
        };
        match steps {
            0 if placed.elapsed() < held => return Ok(Ok(pulse)),
            0 => walk.say("  | it went back meanwhile, after 30 s: look once more"),
            steps => pulse = (pulse + STEP_US * steps as f32).clamp(PULSE_MIN_US, PULSE_MAX_US),
        }
    }
}

/// `+++`, `--`, `+12` as steps.
fn moves(reply: &str) -> Option<i32> {
    let sign = reply.chars().next().filter(|sign| matches!(sign, '+' | '-'))?;
    let count: i32 = match reply.get(1..)?.parse() {
        Ok(count) => count,
        Err(_) if reply.chars().all(|c| c == sign) => reply.len() as i32,
        Err(_) => return None,
    };
    let allowed = (1..=MOST_STEPS).contains(&count);
    allowed.then_some(if sign == '+' { count } else { -count })
}

/// Turns rotor `rotor`, 0 to 3, at `throttle` for two seconds; the vehicle's reason if it refuses.
fn spin(
    walk: &mut Walk<'_>,
    rotor: usize,
    kind: MotorTestThrottleType,
    throttle: f32,
) -> Result<Option<String>, Stop> {
    let motor = (rotor + 1) as f32;
    let kind = kind as u8;
    walk.order(
        MavCmd::MAV_CMD_DO_MOTOR_TEST,
        &[motor, f32::from(kind), throttle, SPIN_TIME],
    )
}

/// Turns a motor and asks whether it does; the vehicle's reason if it refuses.
fn turns(
    walk: &mut Walk<'_>,
    rotor: usize,
    kind: MotorTestThrottleType,
    throttle: f32,
) -> Result<Result<bool, String>, Stop> {
    if let Some(refused) = spin(walk, rotor, kind, throttle)? {
        return Ok(Err(refused));
    }
    let reply = walk.one_of("Did it turn, evenly, and beep no more? y or n:", "yn")?;
    Ok(Ok(reply == "y"))
}

pub(super) fn esc(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    // The motor outputs are set first: they are in force, after a restart, before the motors turn.
    let idle = if by_pulses(&walk.vehicle.values()?.params()) {
        let idle = esc_idle(walk)?;
        if !idle.passed {
            return Ok(idle);
        }
        if let Some(refused) = walk.propellers_off()? {
            return Ok(Verdict::of(false, vec![refused]));
        }
        idle
    } else {
        Verdict::default()
    };
    let mut verdict = esc_protocol(walk)?;
    verdict.figures.splice(0..0, idle.figures);
    verdict.parameters.extend(idle.parameters);
    Ok(verdict)
}

/// Tests each speed controller in turn; the builder confirms that the motor responds to the protocol.
fn esc_protocol(walk: &mut Walk<'_>) -> Judged {
    let params = walk.vehicle.values()?.params();
    let name = protocol(&params);
    if by_pulses(&params) {
        walk.say("  | no ends are taught: BLHeli, AM32, Afro by their makers' procedure, DJI never");
    }
    for rotor in 0..4 {
        let number = rotor + 1;
        walk.say(&format!("  | motor {number} by {name}"));
        let percent = MotorTestThrottleType::MOTOR_TEST_THROTTLE_PERCENT;
        match turns(walk, rotor, percent, SPIN_DRIVE * 100.0)? {
            Ok(true) => (),
            Ok(false) => {
                let next = if by_pulses(&params) {
                    "or turns later; motor_pulse_min and motor_pulse_max are its ends"
                } else {
                    "another protocol: motor_protocol in the step setup"
                };
                let line = format!("controller {number} does not take {name}, or has no power; {next}");
                return Ok(Verdict::of(false, vec![line]));
            }
            Err(refused) => return Ok(Verdict::of(false, vec![refused])),
        }
    }
    let line = format!("all four controllers take {name}; nothing to store");
    Ok(Verdict::of(true, vec![line]))
}

/// Raises each motor's pulse until the builder sees it turn. Friction is largest at rest, so that pulse also keeps the
/// motor turning. The largest of the four pulses is stored.
fn esc_idle(walk: &mut Walk<'_>) -> Judged {
    let params = walk.vehicle.values()?.params();
    // With invalid pulse parameters the vehicle refuses the first order.
    let pulses = MotorPulses::from_params(&params).unwrap_or(MotorPulses::DIGITAL);
    let mut pulse = pulses.pulse_us(0.0) + FIRST_US;
    for rotor in 0..4 {
        let number = rotor + 1;
        loop {
            if pulses.command(pulse) > SPIN_DRIVE_MAX {
                let line = format!("motor {number} does not turn: power? motor_pulse_min, motor_pulse_max?");
                return Ok(Verdict::of(false, vec![line]));
            }
            walk.say(&format!("  | motor {number} at {pulse:.0} us"));
            match turns(walk, rotor, MotorTestThrottleType::MOTOR_TEST_THROTTLE_PWM, pulse)? {
                Ok(true) => break,
                Ok(false) => pulse += STEP_US,
                Err(refused) => return Ok(Verdict::of(false, vec![refused])),
            }
        }
    }
    match walk.set("motor_pulse_idle", pulse)? {
        Ok(line) => {
            let mut verdict = Verdict::of(true, vec![line]);
            verdict.parameters = walk.keep()?;
            Ok(verdict)
        }
        Err(refused) => Ok(Verdict::of(false, vec![refused])),
    }
}

/// Name of the motors' protocol.
fn protocol(params: &Params) -> &'static str {
    let value = params.get("motor_protocol").unwrap_or_default();
    let row = Params::row("motor_protocol");
    row.and_then(|row| row.choice(value))
        .map_or("", |choice| choice.name)
}

pub(super) fn rotors(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    let mut verdict = order_of_rotors(walk)?;
    // The motor order is stored; the turning rotors are compared with it once more.
    verdict.parameters = walk.keep()?;
    if !verdict.passed && !verdict.parameters.is_empty() {
        walk.say("  The order of the wires is stored. Once more, to see it right:");
        if let Some(refused) = walk.propellers_off()? {
            return Ok(Verdict::of(false, vec![refused]));
        }
        let again = order_of_rotors(walk)?;
        verdict.passed = again.passed;
        verdict.figures.extend(again.figures);
        verdict.parameters.extend(walk.keep()?);
    }
    Ok(verdict)
}

/// Spins each output in turn, asks for rotor and direction, and sets `motor_map` if the wires are in another order.
fn order_of_rotors(walk: &mut Walk<'_>) -> Judged {
    walk.say("  | 1 front-left, 2 rear-left, 3 front-right, 4 rear-right");
    let in_force = walk.vehicle.values()?.params().motor_map;
    let mut seen = [Seen {
        rotor: None,
        clockwise: false,
    }; 4];
    for (output, (slot, rotor)) in seen.iter_mut().zip(in_force.rotors()).enumerate() {
        match look_at(walk, output, rotor)? {
            Ok(answer) => *slot = answer,
            Err(refused) => return Ok(Verdict::of(false, vec![refused])),
        }
    }
    let mut figures = Vec::new();
    let mut right = true;
    for (output, wanted) in in_force.rotors().into_iter().enumerate() {
        right &= judged(output, wanted, &seen, &mut figures);
    }
    // An output without a rotor gets an index out of range, which makes the order invalid.
    let found = MotorMap::of(seen.map(|answer| answer.rotor.unwrap_or(seen.len())));
    if let Some(map) = found.filter(|map| *map != in_force) {
        match walk.set("motor_map", map.number())? {
            Ok(line) | Err(line) => figures.push(line),
        }
    }
    figures.push(if right {
        "all rotors as they should".to_owned()
    } else {
        "wires are swapped with the battery off".to_owned()
    });
    Ok(Verdict::of(right, figures))
}

/// Spins the motor at `output` (`rotor` in the map in force) until the builder answers; the vehicle's reason if it
/// refuses.
fn look_at(walk: &mut Walk<'_>, output: usize, rotor: usize) -> Result<Result<Seen, String>, Stop> {
    let number = output + 1;
    loop {
        walk.say(&format!("  | output {number} turns for {SPIN_TIME} s"));
        let percent = MotorTestThrottleType::MOTOR_TEST_THROTTLE_PERCENT;
        if let Some(refused) = spin(walk, rotor, percent, SPIN_DRIVE * 100.0)? {
            return Ok(Err(refused));
        }
        let which = walk.one_of("Which rotor turned, 1 to 4, 0 for none, r once more?", "01234r")?;
        if which == "r" {
            continue;
        }
        let rotor = which.parse::<usize>().ok().and_then(|rotor| rotor.checked_sub(1));
        if rotor.is_none() {
            return Ok(Ok(Seen {
                rotor,
                clockwise: false,
            }));
        }
        let way = walk.one_of(
            "From above, clockwise (c) or anticlockwise (a), r once more?",
            "car",
        )?;
        if way != "r" {
            return Ok(Ok(Seen {
                rotor,
                clockwise: way == "c",
            }));
        }
    }
}

/// Judges the answer about `output`; true if it is the rotor `wanted` with the correct direction.
fn judged(output: usize, wanted: usize, seen: &PerArm<Seen>, lines: &mut Vec<String>) -> bool {
    let number = output + 1;
    let answer = seen.get(output).copied();
    let Some((rotor, clockwise)) = answer.and_then(|answer| Some((answer.rotor?, answer.clockwise))) else {
        lines.push(format!(
            "output {number}: nothing turned; its controller is tested by the step esc"
        ));
        return false;
    };
    let turned = rotor + 1;
    let (place, turns_clockwise) = ROTORS.get(rotor).copied().unwrap_or_default();
    let twice = seen.iter().filter(|other| other.rotor == Some(rotor)).count() > 1;
    let reversed = clockwise != turns_clockwise;
    let right = rotor == wanted && !reversed && !twice;
    lines.push(if twice {
        format!("output {number}: rotor {turned} was named twice")
    } else {
        let verdict = if right { ", as it should" } else { "" };
        format!("output {number}: rotor {turned}, {place}{verdict}")
    });
    if reversed {
        let way = if turns_clockwise {
            "clockwise"
        } else {
            "anticlockwise"
        };
        lines.push(format!(
            "output {number}: rotor {turned} must turn {way}; swap two of its motor's three wires"
        ));
    }
    right
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moves_of_a_servo_are_counted() {
        for (reply, steps) in [
            ("+", Some(1)),
            ("---", Some(-3)),
            ("+4", Some(4)),
            ("-12", Some(-12)),
        ] {
            assert_eq!(moves(reply), steps, "{reply}");
        }
        for reply in ["", "x", "+-", "+x", "5", "+1000", "+ 1", "+0", "+-3"] {
            assert!(moves(reply).is_none(), "{reply}");
        }
    }

    #[test]
    fn an_output_is_judged_by_rotor_and_direction() {
        let at = |rotor, clockwise| Seen {
            rotor: Some(rotor),
            clockwise,
        };
        let mut lines = Vec::new();
        let seen = [at(0, false), at(1, false), at(2, true), at(2, true)];
        assert!(judged(0, 0, &seen, &mut lines));
        assert!(!judged(1, 1, &seen, &mut lines));
        assert!(!judged(2, 2, &seen, &mut lines));
        assert_eq!(
            lines,
            [
                "output 1: rotor 1, front-left, as it should",
                "output 2: rotor 2, rear-left",
                "output 2: rotor 2 must turn clockwise; swap two of its motor's three wires",
                "output 3: rotor 3 was named twice"
            ]
        );
    }
}
