//! Lag of the motors by sound: the tied rotor steps between two drives while a phone beside it records.

use std::path::Path;

use sophie_control::pilot::static_thrust_test::{Rotors, StaticThrustTest};
use sophie_fit::motor_lag::{self, MotorLag};
use sophie_fit::rotor_sound::{self, Sound};

use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step, tied};

/// Drives of the train, share of full drive: about the hover, and far enough apart for the ear of a phone.
const DRIVES: [f32; 2] = [0.3, 0.6];

pub(super) fn lag(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    walk.say("  | As for static thrust: body screwed to its stand, nothing within 0.5 m of a disc.");
    walk.say(
        "  | A phone 0.3 m below rotor 1, out of its plane and its air, records sound as WAV, at most 60 s.",
    );
    if let Some(refused) = tied::tied_down(walk)? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    let test = StaticThrustTest::train(Rotors::One(0), DRIVES[0], DRIVES[1]);
    let found = loop {
        walk.ask("Does the phone record? Enter steps rotor 1 five times between 30 and 60 %, 12 s:")?;
        match tied::run_test(walk, &test, tied::number())? {
            Ok(_) => {
                if let Some(found) = recording(walk, &test)? {
                    break found;
                }
            }
            Err(why) => {
                walk.say(&format!("  | {why}"));
                if let Some(refused) = tied::tied_down(walk)? {
                    return Ok(Verdict::of(false, vec![refused]));
                }
            }
        }
    };
    let mut verdict = Verdict::of(
        true,
        vec![
            format!("gains speed in {:.3} +- {:.3} s", found.up.tau, found.up.half),
            format!(
                "loses speed in {:.3} +- {:.3} s (95 %)",
                found.down.tau, found.down.half
            ),
        ],
    );
    match walk.set("motor_tau", found.lag().tau as f32)? {
        Ok(line) => verdict.figures.push(line),
        Err(refused) => return Ok(Verdict::of(false, vec![refused])),
    }
    verdict.parameters = walk.keep()?;
    Ok(verdict)
}

/// The lag in the recording that the builder names; `None` for another run.
fn recording(walk: &mut Walk<'_>, test: &StaticThrustTest) -> Result<Option<MotorLag>, Stop> {
    loop {
        let file = walk.ask("Stop the recording. Its file, on this computer (r: once more):")?;
        if file == "r" {
            return Ok(None);
        }
        match heard(Path::new(&file), test) {
            Ok(found) => return Ok(Some(found)),
            Err(why) => walk.say(&format!("  | {why}")),
        }
    }
}

fn heard(file: &Path, test: &StaticThrustTest) -> Result<MotorLag, String> {
    let track = rotor_sound::follow(&Sound::load(file)?)?;
    motor_lag::fit(&track, f64::from(test.plateau))
}
