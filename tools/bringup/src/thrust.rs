//! Static thrust on a kitchen scale: the vehicle is tied down, propellers on. Each run is ordered and renewed while the
//! builder watches the scale; the fit gives largest thrust, curve, trims and the power of the voltage.

use std::ops::RangeInclusive;

use sophie_control::params::Params;
use sophie_control::pilot::static_thrust_test::PLATEAU;
use sophie_fit::thrust::{self, SCATTER_MAX, ThrustFit, WORST_MAX};
use sophie_fit::thrust_data::{GRAVITY, Reading};

use super::tied::{self, Measured};
use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};

/// Drives of all rotors together, %: from below the hover to full.
const TOGETHER: [f64; 5] = [45.0, 55.0, 70.0, 85.0, 100.0];
/// Drives of each rotor alone, two of those above: the fit compares readings at one drive.
const ALONE: [f64; 2] = [55.0, 85.0];
/// Typed readings over what the parameters expect that are asked for once more.
const USUAL: RangeInclusive<f64> = 0.5..=2.0;
/// Plausible factors of one rotor: 5 % are usual, 15 % are a damaged propeller, or one of another kind.
const TRIMS: RangeInclusive<f64> = 0.85..=1.15;
/// Least lift of four rotors over the weight.
const LIFT_MIN: f64 = 1.3;

/// A run and what is read.
struct Row {
    name: String,
    reading: Reading,
}

pub(super) fn thrust(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    let params = walk.vehicle.values()?.params();
    walk.say("  | Screw the body to a stand on the scale, best upside down: the air goes up.");
    walk.say("  | Upright it wants 5 kg of ballast, and its discs 0.5 m above scale and table.");
    walk.say("  | Nothing within 0.5 m of a disc. Stand 3 m away, out of their planes; goggles.");
    walk.say("  | The arm switch, Enter and Ctrl-C stop the rotors, and so does a turn by 15 deg.");
    let mut rows = Vec::new();
    // Numbers of runs that no earlier session has given.
    let mut run = tied::number();
    if let Some(refused) = tied::tied_down(walk)? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    battery(walk, &params, &mut run, true, &mut rows)?;
    let second = walk.one_of(
        "A used battery, a third of its charge left, tells what the voltage does: u it is in, n none:",
        "un",
    )?;
    if second == "u" {
        walk.ready()?;
        if let Some(refused) = tied::tied_down(walk)? {
            return Ok(Verdict::of(false, vec![refused]));
        }
        battery(walk, &params, &mut run, false, &mut rows)?;
    }
    let readings: Vec<Reading> = rows.iter().map(|row| row.reading).collect();
    let fit = match thrust::fit(&readings, f64::from(params.battery_nominal)) {
        Ok(fit) => fit,
        Err(why) => return Ok(Verdict::of(false, vec![why])),
    };
    let mut verdict = judged(&fit, &rows, &params);
    if !verdict.passed {
        return Ok(verdict);
    }
    for (name, value) in values(&fit, &params) {
        match walk.set(name, value)? {
            Ok(line) => verdict.figures.push(line),
            Err(refused) => return Ok(Verdict::of(false, vec![refused])),
        }
    }
    verdict.parameters = walk.keep()?;
    Ok(verdict)
}

/// All runs with one battery: all rotors at each drive, and, if `alone`, each rotor.
fn battery(
    walk: &mut Walk<'_>,
    params: &Params,
    run: &mut u32,
    alone: bool,
    rows: &mut Vec<Row>,
) -> Result<(), Stop> {
    let together = TOGETHER.iter().map(|percent| (None, *percent));
    let each = (0..4).flat_map(|rotor| ALONE.iter().map(move |percent| (Some(rotor), *percent)));
    let runs: Vec<(Option<usize>, f64)> = together.chain(each.filter(|_| alone)).collect();
    for (rotor, percent) in runs {
        let who = rotor.map_or("all rotors".to_owned(), |rotor| format!("rotor {}", rotor + 1));
        let name = format!("{who} at {percent:.0} %");
        let reading = loop {
            // A weak battery does not give full drive.
            if walk.ask(&format!("Scale at 0 g? Enter runs {name}, n leaves it out:"))? == "n" {
                break None;
            }
            *run += 1;
            match tied::run(walk, rotor, percent, PLATEAU, *run)? {
                Ok(measured) => {
                    if let Some(reading) = read(walk, params, rotor, percent, &measured)? {
                        break Some(reading);
                    }
                }
                Err(why) => {
                    walk.say(&format!("  | {why}"));
                    if let Some(refused) = tied::tied_down(walk)? {
                        walk.say(&format!("  | {refused}"));
                    }
                }
            }
        };
        rows.extend(reading.map(|reading| Row { name, reading }));
    }
    Ok(())
}

/// The reading that the builder types; `None` for another run.
fn read(
    walk: &mut Walk<'_>,
    params: &Params,
    rotor: Option<usize>,
    percent: f64,
    measured: &Measured,
) -> Result<Option<Reading>, Stop> {
    let voltage = measured.voltage();
    let arms = 0..4;
    let tilts: Vec<f64> = arms
        .filter(|arm| rotor.is_none_or(|rotor| rotor == *arm))
        .filter_map(|arm| measured.tilt(arm))
        .collect();
    // An arm whose sensor is silent counts as level: 20 degrees are 6 %.
    let tilt = tilts.iter().sum::<f64>() / tilts.len().max(1) as f64;
    let command = 0.01 * percent;
    let rotors = if rotor.is_some() { 1.0 } else { 4.0 };
    let expected = rotors * tied::thrust(params, None, command, voltage) * tilt.cos() / GRAVITY * 1e3;
    let mut odd = None;
    loop {
        let reply = walk.ask("What the scale showed at the end, g (r: run it once more):")?;
        if reply == "r" {
            return Ok(None);
        }
        let Some(grams) = reply
            .parse()
            .ok()
            .filter(|grams: &f64| (1.0..20_000.0).contains(grams))
        else {
            walk.say("  | allowed are 1 to 20000 g, without a sign, or r");
            continue;
        };
        if !USUAL.contains(&(grams / expected)) && odd != Some(grams) {
            odd = Some(grams);
            walk.say(&format!(
                "  | the parameters expect {expected:.0} g; type it again if {grams:.0} g is right"
            ));
            continue;
        }
        return Ok(Some(Reading {
            command,
            voltage,
            rotor,
            force: 1e-3 * GRAVITY * grams,
            tilt,
        }));
    }
}

/// The verdict on `fit`, with its figures.
fn judged(fit: &ThrustFit, rows: &[Row], params: &Params) -> Verdict {
    let mut figures: Vec<String> = fit
        .parameters()
        .iter()
        .map(|found| {
            let unit = if found.unit.is_empty() { "" } else { " " };
            format!(
                "{} {:.3} +- {:.3}{unit}{} (95 %)",
                found.name, found.value, found.half, found.unit
            )
        })
        .collect();
    if fit.power.is_none() {
        figures.push("the voltage's power is assumed: one battery does not tell it".to_owned());
    }
    if let Some(scatter) = fit.scatter {
        figures.push(format!("a reading scatters by {:.1} %", 100.0 * scatter));
    }
    let lift = 4.0 * fit.max.value / (f64::from(params.mass) * GRAVITY);
    let (row, distance) = fit.worst;
    let name = rows.get(row).map_or("", |row| row.name.as_str());
    let mut checks = vec![
        (
            fit.scatter.is_none_or(|scatter| scatter <= SCATTER_MAX),
            format!(
                "scatter above {:.0} %: wash on the scale, or what ties it pulls",
                100.0 * SCATTER_MAX
            ),
        ),
        (
            distance.abs() <= WORST_MAX,
            format!(
                "{name}: {:+.0} % beside the others; mistyped, or motor_pulse_max is beyond the controllers' end",
                100.0 * distance
            ),
        ),
        (
            lift >= LIFT_MIN,
            format!("four rotors lift {lift:.2} times the weight; {LIFT_MIN} at least is flown"),
        ),
    ];
    checks.extend(fit.trims.iter().flatten().map(|trim| {
        let number = trim.name.chars().last().unwrap_or_default();
        (
            TRIMS.contains(&trim.value),
            format!(
                "rotor {number} gives {:.2} times the mean; {} to {} is sound: propeller, its screw?",
                trim.value,
                TRIMS.start(),
                TRIMS.end()
            ),
        )
    }));
    let bad: Vec<String> = checks
        .into_iter()
        .filter(|(good, _)| !good)
        .map(|(_, why)| why)
        .collect();
    let passed = bad.is_empty();
    figures.extend(bad);
    Verdict::of(passed, figures)
}

/// Parameters and their values. The arms stay level at the same thrust, which is a share of the largest.
fn values(fit: &ThrustFit, params: &Params) -> Vec<(&'static str, f32)> {
    let found = fit.parameters();
    let mut values: Vec<(&'static str, f32)> = found
        .iter()
        .map(|found| (found.name, rounded(found.value)))
        .collect();
    let level = f64::from(params.arm_level_share) * f64::from(params.thrust_max) / fit.max.value;
    values.push(("arm_level_share", rounded(level)));
    values
}

/// To four decimals: what follows is noise.
fn rounded(value: f64) -> f32 {
    ((value * 1e4).round() * 1e-4) as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(change: impl Fn(&mut Reading)) -> Vec<Row> {
        let mut rows = Vec::new();
        let together = TOGETHER.iter().map(|percent| (None, *percent));
        let each = (0..4).flat_map(|rotor| ALONE.iter().map(move |percent| (Some(rotor), *percent)));
        for (voltage, all) in [(16.0, true), (14.8, false)] {
            for (rotor, percent) in together.clone().chain(each.clone().filter(|_| all)) {
                let command = 0.01 * percent;
                let rotors = if rotor.is_some() { 1.0 } else { 4.0 };
                let mut reading = Reading {
                    command,
                    voltage,
                    rotor,
                    force: rotors * tied::thrust(&Params::DEFAULT, None, command, voltage),
                    tilt: 0.0,
                };
                change(&mut reading);
                rows.push(Row {
                    name: format!("{rotor:?} at {percent} %"),
                    reading,
                });
            }
        }
        rows
    }

    fn verdict(change: impl Fn(&mut Reading)) -> Verdict {
        let rows = rows(change);
        let readings: Vec<Reading> = rows.iter().map(|row| row.reading).collect();
        judged(&thrust::fit(&readings, 14.8).unwrap(), &rows, &Params::DEFAULT)
    }

    #[test]
    fn sound_readings_pass_and_the_default_s_own_give_it_back() {
        let rows = rows(|_| ());
        let readings: Vec<Reading> = rows.iter().map(|row| row.reading).collect();
        let fit = thrust::fit(&readings, 14.8).unwrap();
        assert!(judged(&fit, &rows, &Params::DEFAULT).passed);
        let p = Params::DEFAULT;
        for (name, value) in values(&fit, &p) {
            assert!((value - p.get(name).unwrap()).abs() < 1e-4, "{name} {value}");
        }
    }

    #[test]
    fn a_mistyped_reading_a_damaged_propeller_and_weak_rotors_fail_with_their_reason() {
        let fails = |change: fn(&mut Reading), why: &str| {
            let verdict = verdict(change);
            assert!(!verdict.passed, "{why}");
            assert!(
                verdict.figures.iter().any(|line| line.contains(why)),
                "{verdict:?}"
            );
        };
        let typo = |r: &mut Reading| {
            if r.rotor.is_none() && r.command > 0.8 && r.command < 0.9 && r.voltage > 15.0 {
                r.force *= 1.3;
            }
        };
        fails(typo, "None at 85 %: +");
        fails(typo, "scatter above 3 %");
        fails(
            |r| {
                r.force *= match r.rotor {
                    Some(2) => 0.7,
                    Some(_) => 1.0,
                    None => 0.925,
                }
            },
            "rotor 3 gives 0.76 times the mean",
        );
        fails(|r| r.force *= 0.6, "four rotors lift 1.1");
    }

    #[test]
    fn stronger_rotors_leave_the_arms_level_at_the_same_thrust() {
        let rows = rows(|r| r.force *= 1.1);
        let readings: Vec<Reading> = rows.iter().map(|row| row.reading).collect();
        let p = Params::DEFAULT;
        let found = values(&thrust::fit(&readings, 14.8).unwrap(), &p);
        let of = |name| found.iter().find(|(n, _)| *n == name).unwrap().1;
        let before = p.arm_level_share * p.thrust_max;
        assert!((of("thrust_max") - 1.1 * p.thrust_max).abs() < 1e-3);
        assert!((of("arm_level_share") * of("thrust_max") - before).abs() < 1e-3);
    }
}
