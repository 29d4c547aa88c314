//! Tables of all four arms, bent by their own rotors: the vehicle is tied down by its body, the arms free.

use sophie_control::params::Params;
use sophie_fit::arm::Fit;
use sophie_fit::arm_data::Point;
use sophie_fit::arm_table::{self, ArmPoint, ArmsFit};

use super::tied;
use super::walk::{Stop, Verdict, Walk};
use super::{Judged, Step};

/// Drives, %: 1.5 to 7 N of a fresh battery.
const DRIVES: [f64; 5] = [30.0, 45.0, 60.0, 75.0, 90.0];
/// Time at a drive, s: printed TPU creeps by 1 % more in ten times as long.
const HOLD: f32 = 5.0;
/// Largest scatter of sound tilts about one equation for four arms, deg: prints and their offsets differ.
const RESIDUAL_MAX: f64 = 5.0;
/// Name of the table beside the protocol.
const FILE: &str = "arm-bench.csv";

pub(super) fn arm_table(walk: &mut Walk<'_>, _: &Step) -> Judged {
    walk.ready()?;
    let params = walk.vehicle.values()?.params();
    tied::warn(walk);
    walk.say("  | Level, held by the body alone: nothing may touch the arms.");
    if let Some(refused) = tied::tied_down(walk)? {
        return Ok(Verdict::of(false, vec![refused]));
    }
    let mut points = Vec::new();
    for percent in DRIVES {
        loop {
            walk.ask(&format!("Enter runs all rotors at {percent:.0} %:"))?;
            match tied::run(walk, None, percent, HOLD, tied::number())? {
                Ok(measured) => match bent(&params, percent, &measured) {
                    Ok(found) => {
                        points.extend(found);
                        break;
                    }
                    Err(silent) => return Ok(Verdict::of(false, vec![silent])),
                },
                Err(why) => {
                    walk.say(&format!("  | {why}"));
                    if let Some(refused) = tied::tied_down(walk)? {
                        walk.say(&format!("  | {refused}"));
                    }
                }
            }
        }
    }
    let file = walk.beside(FILE);
    std::fs::write(&file, arm_table::csv(&points)).map_err(|error| {
        Stop::Failed(sophie_board_link::Failure::Input(format!(
            "{}: {error}",
            file.display()
        )))
    })?;
    let fit = match arm_table::fit(&points, table_1()) {
        Ok(fit) => fit,
        Err(why) => return Ok(Verdict::of(false, vec![why])),
    };
    let mut verdict = judged(&fit);
    verdict
        .figures
        .push(format!("table {}, for sophie fit-arm", file.display()));
    if !verdict.passed {
        return Ok(verdict);
    }
    let values = match fit.parameters(f64::from(params.thrust_max)) {
        Ok(values) => values,
        Err(why) => return Ok(Verdict::of(false, vec![why])),
    };
    for (name, value) in values {
        match walk.set(name, ((value * 1e4).round() * 1e-4) as f32)? {
            Ok(line) => verdict.figures.push(line),
            Err(refused) => return Ok(Verdict::of(false, vec![refused])),
        }
    }
    verdict.parameters = walk.keep()?;
    Ok(verdict)
}

/// The points of a run; which sensor is silent.
fn bent(params: &Params, percent: f64, measured: &tied::Measured) -> Result<Vec<ArmPoint>, String> {
    (0..4)
        .map(|arm| {
            let tilt = measured
                .tilt(arm)
                .ok_or_else(|| format!("sensor of arm {} is silent", arm + 1))?;
            let point = Point {
                infill: f64::from(params.infill),
                thrust: tied::thrust(params, Some(arm), 0.01 * percent, measured.voltage()),
                tilt: tilt.to_degrees(),
                power: 1.0,
            };
            Ok(ArmPoint { arm, point })
        })
        .collect()
}

/// Table I of the paper, the defaults of the parameters.
fn table_1() -> [f64; 4] {
    let p = Params::DEFAULT;
    [p.arm_a1, p.arm_a2, p.arm_b1, p.arm_b2].map(f64::from)
}

fn judged(fit: &ArmsFit) -> Verdict {
    let Fit { fitted, residual, .. } = &fit.all;
    let mut figures: Vec<String> = fitted
        .iter()
        .map(|f| {
            format!(
                "{} {:.3} +- {:.3} {}",
                ascii(f.name),
                f.value,
                f.half,
                ascii_unit(f.unit)
            )
        })
        .collect();
    figures.push(format!(
        "tilts {residual:.1} deg off it RMS ({RESIDUAL_MAX} at most)"
    ));
    for (arm, own) in fit.arms.iter().enumerate() {
        let ((gain, gain_half), (offset, offset_half)) = (own.gain, own.offset);
        figures.push(format!(
            "arm {} bends {gain:.2} +- {gain_half:.2} of it, {offset:+.1} +- {offset_half:.1} deg at rest",
            arm + 1
        ));
    }
    Verdict::of(*residual <= RESIDUAL_MAX, figures)
}

/// Names and units as a terminal of any kind shows them.
fn ascii(name: &str) -> &str {
    if name == "α0" { "a0" } else { name }
}

fn ascii_unit(unit: &str) -> &'static str {
    match unit {
        "°" => "deg",
        "°/N" => "deg/N",
        "°/N²" => "deg/N2",
        _ => "",
    }
}
