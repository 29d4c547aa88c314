//! Steps that run the console's dialogues `calibrate` and `rotors`.

use sophie_control::maths::decimal;

use super::checks::takes_pulses;
use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};

/// Ends of the last line of a successful calibration.
const TAKEN: [&str; 3] = [", in force after save", ", as in force", "nothing to store"];

/// Runs the dialogue of `command`, stores its result, and judges by its last line.
fn calibrated(walk: &mut Walk<'_>, command: &str) -> Judged {
    calibrated_then(walk, command, None)
}

/// As [`calibrated`]; asks `first` of the builder before the board restarts with the new values.
fn calibrated_then(walk: &mut Walk<'_>, command: &str, first: Option<&str>) -> Judged {
    let said = walk.dialogue(command)?;
    let last = said.last().map_or("", String::as_str);
    let taken = TAKEN.iter().any(|text| last.ends_with(text));
    let mut verdict = Verdict {
        shown: true,
        ..Verdict::of(taken, figures(&said))
    };
    if taken {
        if let Some(first) = first {
            walk.ask(first)?;
        }
        verdict.parameters = walk.keep(&said)?;
    }
    Ok(verdict)
}

/// The results, without the instructions.
fn figures(said: &[String]) -> Vec<String> {
    let found = |line: &&String| {
        let line = line.as_str();
        line.contains(" -> ")
            || TAKEN.iter().any(|text| line.ends_with(text))
            || [
                "not ",
                "scale ",
                "output ",
                "ended",
                "refused",
                "controller ",
                "all ",
                "after the change",
                "after 'save'",
                "nose is",
                "turned about",
            ]
            .iter()
            .any(|begin| line.starts_with(begin))
    };
    let mut figures: Vec<String> = said.iter().filter(found).cloned().collect();
    if figures.is_empty() {
        figures.extend(said.last().cloned());
    }
    figures
}

pub(super) fn mounting(walk: &mut Walk<'_>, _: &Step) -> Judged {
    calibrated(walk, "calibrate mounting")
}

pub(super) fn gyro(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    calibrated(walk, "calibrate gyro")
}

pub(super) fn level(walk: &mut Walk<'_>, _: &Step) -> Judged {
    loop {
        match &*walk.ask("Enter for the level table, 6 for six sides:")? {
            "" => return calibrated(walk, "calibrate level"),
            "6" => return calibrated(walk, "calibrate accel"),
            _ => (),
        }
    }
}

pub(super) fn arm(walk: &mut Walk<'_>, step: &Step) -> Judged {
    calibrated(walk, &format!("calibrate arm {}", step.number))
}

pub(super) fn fsr(walk: &mut Walk<'_>, step: &Step) -> Judged {
    let last = walk.weight.clone();
    let question = format!("Weight in N, 132 g are 1.3 N; Enter for {last}:");
    let weight = number(walk, &question, Some(last))?;
    walk.weight.clone_from(&weight);
    // A board that starts with a pressed sensor takes its arms for closed.
    let free = Some("Take the weight off, then Enter:");
    calibrated_then(walk, &format!("calibrate fsr {} {weight}", step.number), free)
}

pub(super) fn servo(walk: &mut Walk<'_>, step: &Step) -> Judged {
    walk.ready()?;
    calibrated(walk, &format!("calibrate servo {}", step.number))
}

/// A vehicle without a module needs no calibration of it.
pub(super) fn flow(walk: &mut Walk<'_>, _: &Step) -> Judged {
    let said = walk.session.command("get flow_port")?;
    if said.first().is_some_and(|line| line.contains(" none")) {
        let none = "no flow module: flow_port is none";
        return Ok(Verdict::of(true, vec![none.to_owned()]));
    }
    walk.ready()?;
    let mut places = Vec::new();
    for place in ["flow_x", "flow_y", "flow_z"] {
        places.extend(walk.session.command(&format!("get {place}"))?);
    }
    let mut verdict = calibrated(walk, "calibrate flow")?;
    verdict.figures.extend(places);
    Ok(verdict)
}

pub(super) fn battery(walk: &mut Walk<'_>, _: &Step) -> Judged {
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    let volts = number(walk, "Volts that the meter shows at the battery's plug:", None)?;
    let mut verdict = calibrated(walk, &format!("calibrate battery {volts}"))?;
    let status = walk.ready()?;
    verdict.figures.push(format!("meter {volts} V"));
    verdict
        .figures
        .extend(status.into_iter().filter(|line| line.starts_with("battery ")));
    Ok(verdict)
}

pub(super) fn esc(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    // The motor outputs are set first: they are in force, after a restart, before the motors turn.
    let idle = if takes_pulses(walk.session)? {
        let idle = calibrated(walk, "calibrate esc idle")?;
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
    let mut verdict = calibrated(walk, "calibrate esc")?;
    verdict.figures.splice(0..0, idle.figures);
    verdict.parameters.extend(idle.parameters);
    Ok(verdict)
}

pub(super) fn rotors(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    if let Some(refused) = walk.propellers_off()? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    let said = walk.dialogue("rotors")?;
    let right = |said: &[String]| {
        said.last()
            .is_some_and(|line| line == "all rotors as they should")
    };
    let mut verdict = Verdict {
        shown: true,
        ..Verdict::of(right(&said), figures(&said))
    };
    // The motor order is stored; the turning rotors are compared with it once more.
    verdict.parameters = walk.keep(&said)?;
    if !verdict.passed && !verdict.parameters.is_empty() {
        walk.say("  The order of the wires is stored. Once more, to see it right:");
        if let Some(refused) = walk.propellers_off()? {
            return Ok(Verdict::of(false, vec![refused]));
        }
        let again = walk.dialogue("rotors")?;
        verdict.passed = right(&again);
        verdict.figures.extend(figures(&again));
        verdict.parameters.extend(walk.keep(&again)?);
    }
    Ok(verdict)
}

/// A number that the builder types; Enter takes `usual`.
fn number(walk: &mut Walk<'_>, question: &str, usual: Option<String>) -> Result<String, Stop> {
    loop {
        let reply = walk.ask(question)?;
        if reply.is_empty()
            && let Some(usual) = &usual
        {
            return Ok(usual.clone());
        }
        if decimal::parse(&reply).is_some() {
            return Ok(reply);
        }
    }
}
