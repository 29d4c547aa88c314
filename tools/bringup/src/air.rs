//! The barometer: found, plausible, quiet at rest, and moved by a metre of height.

use std::ops::RangeInclusive;
use std::time::Duration;

use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};
use mavlink_core::MessageData;
use sophie_dialect::{MavMessage, SCALED_PRESSURE_DATA};

/// Boards that carry a barometer (`BarometerPort` of each board): a silent one is broken. Other boards fly without.
const CARRY: [&str; 2] = ["matek-h743", "cuav-v5"];
/// Period of the samples, µs, and the silence after which a barometer counts as missing.
const PERIOD_US: f32 = 200_000.0;
const SILENCE: Duration = Duration::from_secs(3);
/// Samples, five a second: at rest, lifted, and put down, the last two after samples in which the vehicle still
/// moves.
const REST: usize = 20;
const MOVED: usize = 10;
const SETTLING: usize = 3;
/// Plausible air pressure, hPa.
const PLAUSIBLE: RangeInclusive<f64> = 300.0..=1200.0;
/// Largest noise at rest, Pa RMS: a part has 1.2 at most (MS5611), a draught adds to it.
const NOISE_MAX: f64 = 3.0;
/// Accepted drop of pressure for a lift of about 1 m, Pa: 12 at sea level, 9 at 2,500 m; a lift by hand is half a metre
/// to two.
const METRE: RangeInclusive<f64> = 5.0..=25.0;
/// Largest change of pressure at one place during the step, Pa: weather and an opened door.
const RETURN_MAX: f64 = 5.0;

pub(super) fn air(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.say("  Leave it at rest.");
    let Some(rest) = pressures(walk, REST)? else {
        return missing(walk);
    };
    walk.ask("Lift it by 1 m, hold it there, then Enter:")?;
    let up = pressures(walk, SETTLING + MOVED)?;
    walk.ask("And down again, then Enter:")?;
    let down = pressures(walk, SETTLING + MOVED)?;
    let (Some(up), Some(down)) = (up, down) else {
        let lost = "barometer fell silent while it was lifted: a loose part or bus".to_owned();
        return Ok(Verdict::of(false, vec![lost]));
    };
    Ok(judged(&rest, &up, &down))
}

/// So many pressures, Pa; `None` if the barometer is silent.
fn pressures(walk: &mut Walk<'_>, count: usize) -> Result<Option<Vec<f64>>, Stop> {
    let id = [SCALED_PRESSURE_DATA::ID];
    walk.vehicle.stream(&id, PERIOD_US)?;
    let silence = walk.vehicle.silence(SILENCE);
    let mut found = Vec::new();
    while found.len() < count {
        let sample = walk.vehicle.wait(silence, |message| match message {
            MavMessage::SCALED_PRESSURE(air) => Some((air.press_abs, air.temperature)),
            _ => None,
        })?;
        let Some((hectopascal, centidegrees)) = sample else {
            break;
        };
        let (pascal, degrees) = (f64::from(hectopascal) * 100.0, f64::from(centidegrees) * 0.01);
        walk.user.live(&format!("{pascal:.1} Pa, {degrees:.1} deg C"));
        found.push(pascal);
    }
    walk.vehicle.stream(&id, -1.0)?;
    Ok((found.len() == count).then_some(found))
}

fn missing(walk: &mut Walk<'_>) -> Judged {
    let board = walk.vehicle.identity()?.board;
    let carries = CARRY.contains(&&*board);
    let line = if carries {
        format!("no barometer answers on {board}, which carries one: the log names the fault")
    } else {
        format!("no barometer on {board}")
    };
    let cost = "without it a hold that has lost range and pose ends after 4 s, not 9 s";
    Ok(Verdict::of(!carries, vec![line, cost.to_owned()]))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The verdict on pressures at rest, lifted and put down again, Pa.
fn judged(rest: &[f64], up: &[f64], down: &[f64]) -> Verdict {
    let ground = mean(rest);
    let squares: Vec<f64> = rest.iter().map(|p| (p - ground).powi(2)).collect();
    let noise = mean(&squares).sqrt();
    let [up, down] = [up, down].map(|rows| mean(rows.get(SETTLING..).unwrap_or_default()));
    // Half of the drift had happened when the vehicle was up.
    let (moved, returned) = (up - 0.5 * (ground + down), down - ground);
    let checks = [
        (
            PLAUSIBLE.contains(&(ground * 0.01)),
            format!("pressure {ground:.1} Pa"),
            format!(
                "{} to {} hPa is air; another part or a bad one",
                PLAUSIBLE.start(),
                PLAUSIBLE.end()
            ),
        ),
        (
            noise <= NOISE_MAX,
            format!("noise at rest {noise:.2} Pa RMS"),
            format!("at most {NOISE_MAX}; light or wind on the part wants foam"),
        ),
        (
            METRE.contains(&-moved),
            format!("up by hand {moved:+.1} Pa"),
            format!("1 m takes 12 off; {} to {} is enough", METRE.start(), METRE.end()),
        ),
        (
            returned.abs() <= RETURN_MAX,
            format!("down again {returned:+.1} Pa"),
            format!("at most {RETURN_MAX}; a door, or the part warms up"),
        ),
    ];
    let passed = checks.iter().all(|(right, ..)| *right);
    let figures = checks.map(|(right, figure, wanted)| match right {
        true => figure,
        false => format!("{figure}; {wanted}"),
    });
    Verdict::of(passed, figures.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows at `pascal` with a noise of 0.4 Pa.
    fn rows(pascal: f64, count: usize) -> Vec<f64> {
        let noise = |nth: usize| if nth.is_multiple_of(2) { 0.4 } else { -0.4 };
        (0..count).map(|nth| pascal + noise(nth)).collect()
    }

    #[test]
    fn what_a_barometer_shows_is_judged() {
        let of = |ground: f64, noise: f64, up: f64, down: f64| {
            let rest: Vec<f64> = rows(0.0, REST).iter().map(|p| ground + p * noise / 0.4).collect();
            let moved = SETTLING + MOVED;
            judged(&rest, &rows(ground + up, moved), &rows(ground + down, moved))
        };
        let sound = of(101_325.0, 0.4, -12.0, 0.2);
        assert!(sound.passed, "{sound:?}");
        assert_eq!(
            sound.figures,
            [
                "pressure 101325.0 Pa",
                "noise at rest 0.40 Pa RMS",
                "up by hand -12.1 Pa",
                "down again +0.2 Pa"
            ]
        );
        // In Mexico City, lifted by 0.8 m.
        assert!(of(77_000.0, 1.2, -7.2, -1.0).passed);
        for (wrong, figure) in [
            (of(20_000.0, 0.4, -12.0, 0.0), "pressure 20000.0 Pa; 300 to 1200"),
            (
                of(101_325.0, 4.0, -12.0, 0.0),
                "noise at rest 4.00 Pa RMS; at most 3",
            ),
            (
                of(101_325.0, 0.4, 0.0, 0.0),
                "up by hand +0.0 Pa; 1 m takes 12 off",
            ),
            (
                of(101_325.0, 0.4, 12.0, 0.0),
                "up by hand +12.0 Pa; 1 m takes 12 off",
            ),
            (of(101_325.0, 0.4, -16.0, -8.0), "down again -8.0 Pa; at most 5"),
        ] {
            let found = wrong.figures.iter().any(|line| line.starts_with(figure));
            assert!(!wrong.passed && found, "{wrong:?}");
        }
    }
}
