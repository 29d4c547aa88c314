//! Steps that calibrate: the builder is led, the vehicle measures, and the results are stored.

use sophie_control::calibration::Face;
use sophie_control::calibration::procedure::MOUNTING_SIDES;
use sophie_control::calibration::step::Calibration;
use sophie_control::maths::decimal;
use sophie_control::maths::scalar::GRAVITY;

use super::walk::{Measured, Stop, Verdict, Walk, is_done};
use super::{Judged, Step};

/// Begin of each rest.
const READY: &str = "Enter when it is so, s skips, q stops:";

/// Measures all steps of a calibration, each after its instruction; `value` goes with each.
fn calibrated(
    walk: &mut Walk<'_>,
    calibration: Calibration,
    part: usize,
    instructions: &[(&str, f32)],
) -> Judged {
    let before = walk.before(calibration, part.saturating_sub(1))?;
    for (step, (instruction, value)) in (1..).zip(instructions) {
        walk.say(&format!("  | {instruction}"));
        walk.ask(READY)?;
        match walk.measure(calibration, part, step, [*value, 0.0])? {
            Measured::Bad(line) => return Ok(Verdict::of(false, vec![line])),
            Measured::Good(result) => {
                let last = usize::from(step) == instructions.len();
                if !result.as_ref().map_or(last, is_done) {
                    continue;
                }
                let mut figures = walk.note_changes(calibration, part.saturating_sub(1), &before)?;
                if let Some(result) = result {
                    figures.extend(found(walk, calibration, &result.figures)?);
                }
                return Ok(Verdict::of(true, figures));
            }
        }
    }
    Ok(Verdict::of(
        false,
        vec!["the vehicle wants more steps than this program knows".to_owned()],
    ))
}

/// Results beside the parameters.
fn found(walk: &mut Walk<'_>, calibration: Calibration, figures: &[f32; 4]) -> Result<Option<String>, Stop> {
    let [x, y, z, noise] = figures;
    Ok(match calibration {
        Calibration::Gyro => Some(format!(
            "at rest {x:.2} {y:.2} {z:.2} deg/s, noise {noise:.2}; nothing to store"
        )),
        Calibration::Flow => Some(format!("turned about a point {:.0} cm over the lens", x * 100.0)),
        Calibration::Fsr => {
            let grip = walk.vehicle.value("grip_pressure")?;
            Some(format!(
                "within {x:.0} Pa at {grip} Pa; hysteresis {y:.1} %; {z:.0} Pa at the end, empty"
            ))
        }
        _ => None,
    })
}

/// As [`calibrated`], then stored.
fn stored(
    walk: &mut Walk<'_>,
    calibration: Calibration,
    part: usize,
    instructions: &[&str],
    value: f32,
) -> Judged {
    let instructions: Vec<_> = instructions.iter().map(|text| (*text, value)).collect();
    let mut verdict = calibrated(walk, calibration, part, &instructions)?;
    if verdict.passed {
        verdict.parameters = walk.keep()?;
    }
    Ok(verdict)
}

pub(super) fn mounting(walk: &mut Walk<'_>, _: &Step) -> Judged {
    stored(
        walk,
        Calibration::Mounting,
        0,
        &MOUNTING_SIDES.map(Face::text),
        0.0,
    )
}

pub(super) fn gyro(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    stored(walk, Calibration::Gyro, 0, &["Leave the vehicle at rest."], 0.0)
}

pub(super) fn level(walk: &mut Walk<'_>, _: &Step) -> Judged {
    loop {
        match &*walk.ask("Enter for the level table, 6 for six sides:")? {
            "" => {
                let table = "Put the vehicle on a level table, by a spirit level on its body.";
                return stored(walk, Calibration::Level, 0, &[table], 0.0);
            }
            "6" => return stored(walk, Calibration::Accel, 0, &Face::ALL.map(Face::text), 0.0),
            _ => (),
        }
    }
}

pub(super) fn arm(walk: &mut Walk<'_>, step: &Step) -> Judged {
    walk.ready()?;
    let instructions = [
        "Hold the arm straight, by a ruler along it.",
        "Bend its tip up by a hand's breadth, and hold.",
    ];
    stored(walk, Calibration::Arm, step.number, &instructions, 0.0)
}

pub(super) fn fsr(walk: &mut Walk<'_>, step: &Step) -> Judged {
    let grams = loads(walk)?;
    let [first, second, third] = grams;
    let up_and_down = [first, second, third, second, first];
    let verbs = [
        "Put on",
        "Add up to",
        "Add up to",
        "Take off down to",
        "Take off down to",
    ];
    let texts: Vec<String> = verbs
        .iter()
        .zip(up_and_down)
        .map(|(verb, grams)| format!("{verb} {grams} g, the segment counted, and let it lie."))
        .collect();
    let newtons = up_and_down.map(|grams| grams * 1e-3 * GRAVITY);
    let mut instructions = vec![("Arm in its cradle, pad up. Nothing may touch the pad.", 0.0)];
    instructions.extend(texts.iter().map(String::as_str).zip(newtons));
    instructions.push(("Take all of it off, the segment too.", 0.0));
    let mut verdict = calibrated(walk, Calibration::Fsr, step.number, &instructions)?;
    verdict
        .figures
        .push(format!("loads {first}, {second}, {third} g"));
    if verdict.passed {
        // A board that starts with a sensor that reads a bend takes its arms for closed.
        walk.ask("Take the arm out of its cradle, then Enter:")?;
        verdict.parameters = walk.keep()?;
    }
    Ok(verdict)
}

/// The three loads, g; Enter takes those of the last sensor.
fn loads(walk: &mut Walk<'_>) -> Result<[f32; 3], Stop> {
    loop {
        let question = format!(
            "Three loads in g by a kitchen scale, the segment counted; Enter for {}:",
            walk.loads
        );
        let usual = walk.loads.clone();
        let [first, second, third] = walk.numbers::<3>(&question, Some(&usual))?;
        if first < second && second < third {
            walk.loads = format!("{first} {second} {third}");
            return Ok([first, second, third]);
        }
        walk.say("  | three that rise, such as 100 140 200");
    }
}

/// A vehicle without a module needs no calibration of it.
pub(super) fn flow(walk: &mut Walk<'_>, _: &Step) -> Judged {
    if walk.vehicle.value("flow_port")? <= 0.0 {
        let none = "no flow module: flow_port is none";
        return Ok(Verdict::of(true, vec![none.to_owned()]));
    }
    walk.ready()?;
    let mut places = Vec::new();
    for place in ["flow_x", "flow_y", "flow_z"] {
        places.push(format!("{place} {} m", walk.vehicle.value(place)?));
    }
    let instructions = [
        "Hold it 0.5 m over a floor with a pattern. From Enter on, for 8 s: roll it to both sides, then pitch it.",
        "Now 1.5 m over it, and the same again.",
    ];
    let mut verdict = stored(walk, Calibration::Flow, 0, &instructions, 0.0)?;
    verdict.figures.extend(places);
    Ok(verdict)
}

pub(super) fn battery(walk: &mut Walk<'_>, _: &Step) -> Judged {
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    let (text, volts) = typed(walk, "Volts that the meter shows at the battery's plug:", None)?;
    let instructions = ["Leave the battery connected as it was measured."];
    let mut verdict = stored(walk, Calibration::Battery, 0, &instructions, volts)?;
    verdict.figures.push(format!("meter {text} V"));
    if let Some(volts) = super::live::battery(walk)? {
        verdict.figures.push(format!("battery {volts:.2} V"));
    }
    Ok(verdict)
}

/// A number that the builder types, as text too; Enter takes `usual`.
pub(super) fn typed(
    walk: &mut Walk<'_>,
    question: &str,
    usual: Option<String>,
) -> Result<(String, f32), Stop> {
    loop {
        let reply = walk.ask(question)?;
        let text = match (&usual, reply.is_empty()) {
            (Some(usual), true) => usual.clone(),
            _ => reply,
        };
        if let Some(number) = decimal::parse(&text) {
            return Ok((text, number));
        }
    }
}
