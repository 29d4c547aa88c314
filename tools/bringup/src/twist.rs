//! Torsional stiffness of an arm: weights beside its tip, the twist by a phone. No parameter has it: it goes into the
//! scenario that `sophie check` reads.

use std::time::Duration;

use mavlink_core::MessageData;
use sophie_control::params::Params;
use sophie_dialect::{MavMessage, SOPHIE_ARMS_DATA};
use sophie_fit::twist::{self, Reading};

use super::calibrate::typed;
use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};

/// Weights that are asked for, g: 5 to 15 degrees on the derived stiffness.
const WEIGHTS: [&str; 3] = ["30", "60", "90"];
/// Samples of the arm's tilt, their period, µs, and the longest wait for one.
const SAMPLES: u32 = 10;
const PERIOD_US: f32 = 100_000.0;
const SILENCE: Duration = Duration::from_secs(3);
/// Stiffness over the derived one that `vehicle.arm_torsion` takes.
const ALLOWED: std::ops::RangeInclusive<f64> = 0.3..=3.0;

pub(super) fn twist(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    let arm = loop {
        match &*walk.ask("Which arm, 1 to 4; Enter for 1:")? {
            "" | "1" => break 0,
            "2" => break 1,
            "3" => break 2,
            "4" => break 3,
            _ => (),
        }
    };
    walk.say("  | Clamp the body, nose or tail up, so that this arm's tip is level.");
    walk.say("  | Tie a light rod across the tip, a hook on each end; the phone lies on it.");
    walk.ask("Enter when it is so, s leaves it out, q stops:")?;
    let Some(slope) = slope(walk, arm)? else {
        let silent = format!("sensor of arm {} is silent", arm + 1);
        return Ok(Verdict::of(false, vec![silent]));
    };
    let (_, lever) = typed(
        walk,
        "From the arm's axis to each hook, m; Enter for 0.1:",
        Some("0.1".to_owned()),
    )?;
    let mut masses = Vec::new();
    for usual in WEIGHTS {
        let question = format!("A weight with its thread on a kitchen scale, g; Enter for {usual}:");
        masses.push(0.001 * typed(walk, &question, Some(usual.to_owned()))?.1);
    }
    walk.say("  | Twist: positive with the right hook lower, seen from the body.");
    let mut readings = Vec::new();
    let sides = [("right", 1.0), ("left", -1.0)];
    let loads = sides
        .iter()
        .flat_map(|side| masses.iter().map(move |mass| (*side, *mass)));
    let (_, twist) = typed(walk, "Nothing hangs. Twist, deg:", None)?;
    readings.push(reading(0.0, lever, twist));
    for ((side, sign), mass) in loads {
        let question = format!("{:.0} g hang from the {side} hook. Twist, deg:", 1e3 * mass);
        let (_, twist) = typed(walk, &question, None)?;
        readings.push(reading(sign * mass, lever, twist));
    }
    Ok(match twist::fit(&readings, slope) {
        Err(why) => Verdict::of(false, vec![why]),
        Ok(found) => judged(&found, arm, &walk.vehicle.values()?.params()),
    })
}

fn reading(mass: f32, lever: f32, twist: f32) -> Reading {
    Reading {
        mass: f64::from(mass),
        lever: f64::from(lever),
        twist: f64::from(twist),
    }
}

/// Angle between root and tip of `arm`, rad; `None` where its sensor is silent.
fn slope(walk: &mut Walk<'_>, arm: usize) -> Result<Option<f64>, Stop> {
    let id = [SOPHIE_ARMS_DATA::ID];
    walk.vehicle.stream(&id, PERIOD_US)?;
    let silence = walk.vehicle.silence(SILENCE);
    let (mut sum, mut count) = (0.0, 0);
    while count < SAMPLES {
        let tilt = walk.vehicle.wait(silence, |message| match message {
            MavMessage::SOPHIE_ARMS(arms) => arms.tilt.get(arm).copied(),
            _ => None,
        })?;
        let Some(tilt) = tilt.filter(|tilt| tilt.is_finite()) else {
            break;
        };
        sum += f64::from(tilt);
        count += 1;
    }
    walk.vehicle.stream(&id, 0.0)?;
    Ok((count == SAMPLES).then(|| sum / f64::from(SAMPLES)))
}

/// Tilt of an arm by thrust at rest that the parameters have, rad/N.
fn elastic(params: &Params) -> f64 {
    let slope = params.gain_k * (params.arm_a1 + params.infill * params.arm_a2);
    f64::from(slope).to_radians()
}

fn judged(found: &twist::TwistFit, arm: usize, params: &Params) -> Verdict {
    let (value, half) = (found.stiffness.value, found.stiffness.half);
    let derived = twist::derived(elastic(params));
    let share = value / derived;
    Verdict::of(
        ALLOWED.contains(&share),
        vec![
            format!(
                "arm {}: {value:.3} +- {half:.3} N m/rad, readings {:.1} deg off a line",
                arm + 1,
                found.scatter
            ),
            format!("derived of its bending {derived:.3} N m/rad"),
            format!(
                "vehicle.arm_torsion = {share:.2} ({} to {}); nothing to store",
                ALLOWED.start(),
                ALLOWED.end()
            ),
            format!(
                "sophie check FILE, with `arm_torsion = {share:.2}` in its [vehicle], says whether yaw bears it"
            ),
        ],
    )
}
