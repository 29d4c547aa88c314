//! Results of `sophie fit-arm` as a section of a page and as parameters.

use sophie_control::params::Params;
use sophie_sim::scenario::Scenario;

use crate::results::model::{Axis, Cell, Chart, Section, Series, SeriesStyle, Table, num};
use sophie_fit::arm::{Fit, Fitted};
use sophie_fit::arm_data::Point;
use sophie_fit::friction::{self, Surface};
use sophie_fit::tendon::TendonFit;

/// Tilts within this span may be radians: a quarter turn. Table I's stiffest arm (10 %, K = 1) bends by 2.8°.
const RADIANS: f64 = 1.58;
/// Share of a rotor's largest thrust below which hover is extrapolated.
const REACH: f64 = 0.5;
/// May be 0: an arm may be level at rest, and K is not written.
const MAY_BE_NONE: [&str; 2] = ["α0", "K"];

fn span(points: &[Point], of: impl Fn(&Point) -> f64) -> (f64, f64) {
    points
        .iter()
        .map(of)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        })
}

/// Refuses tilts that cannot be degrees.
///
/// # Errors
/// One line: the span and the allowed one.
pub fn check_units(points: &[Point]) -> Result<(), String> {
    let ((low, high), (from, to)) = (span(points, |p| p.tilt), span(points, |p| p.thrust));
    if high - low > RADIANS {
        return Ok(());
    }
    Err(format!(
        "tilt_deg spans {:.2} over thrusts of {from} to {to} N, as an arm in radians does: allowed are degrees, over more \
         than {RADIANS}",
        high - low
    ))
}

/// Largest thrust of data and rotor, N, if the data end too early.
fn reach(points: &[Point]) -> Option<(f64, f64)> {
    let (most, top) = (span(points, |p| p.thrust).1, thrust_max());
    (most < REACH * top).then_some((most, top))
}

fn thrust_max() -> f64 {
    // Drops the `f32`'s further digits.
    (f64::from(Params::default().thrust_max) * 1e4).round() * 1e-4
}

/// Warnings before flying the fit, a line each.
pub fn warnings(points: &[Point], fit: &Fit) -> Vec<String> {
    let mut lines = vec![];
    if let Some((most, top)) = reach(points) {
        lines.push(format!(
            "thrust_n ends at {most:.2} N, less than half of the {top} N that a rotor gives: above it the fit is a guess \
             (thrusts in kgf are 9.81 times too small)"
        ));
    }
    for f in fit
        .fitted
        .iter()
        .filter(|f| !MAY_BE_NONE.contains(&f.name) && f.value.abs() <= f.half)
    {
        lines.push(
            format!(
                "the 95 % interval of {} holds 0 ({:.4} to {:.4} {}): these data do not tell whether it is there",
                f.name,
                f.value - f.half,
                f.value + f.half,
                f.unit
            )
            .replace(" )", ")"),
        );
    }
    lines
}

/// Vehicle's infill, %: the only measured one, or the stack's within the measured.
pub fn infill(points: &[Point]) -> f64 {
    let default = (f64::from(Params::default().infill) * 1e4).round() * 1e-4;
    let (low, high) = span(points, |p| p.infill);
    default.clamp(low, high.max(low))
}

/// The section of the fit, followed by the tendon's and the pipe's if they are given.
pub fn section(points: &[Point], fit: &Fit, tendon: Option<&TendonFit>, surfaces: &[Surface]) -> Section {
    let mut s = Section::new("fit", "Eq. 1 fitted to bench data");
    s.table(coefficients(fit));
    s.text(format!(
        "K is the gain that the paper's Table I would need; its shape leaves {:.2}° RMS where the fit leaves {:.2}°. A \
         C_P without an interval was not measured (no power ratio below 0.95) and is assumed.",
        fit.gain.1, fit.residual
    ));
    for warning in warnings(points, fit) {
        s.text(format!("Warning: {warning}."));
    }
    if let Some(tendon) = tendon {
        tendon_table(&mut s, tendon);
    }
    if !surfaces.is_empty() {
        friction_table(&mut s, surfaces);
    }
    curves(&mut s, points, fit);
    s.finding = format!("{} points, residual {:.2}° RMS.", points.len(), fit.residual);
    s
}

fn show(f: &Fitted) -> [Cell; 5] {
    [
        f.name.into(),
        f.unit.into(),
        num(f.value, 4),
        num(f.value - f.half, 4),
        num(f.value + f.half, 4),
    ]
}

fn tendon_table(s: &mut Section, tendon: &TendonFit) {
    let mut t = Table::new(
        "The tendon, with 95 % confidence intervals",
        &["name", "unit", "value", "from", "to"],
    );
    for f in tendon.bend.iter().chain(&tendon.relief) {
        t.row(show(f));
    }
    s.table(t);
    let [tilt, force] = tendon.residuals;
    s.text(format!(
        "The tendon runs {:.1} mm from the neutral line. Residuals: {tilt:.2}° RMS of the free arm's tilt, {force:.2} N RMS \
         of the force on the pipe.",
        1e3 * tendon.lever
    ));
}

fn friction_table(s: &mut Section, surfaces: &[Surface]) {
    let mut t = Table::new(
        "The skin on the pipe, with 95 % confidence intervals",
        &["pipe", "name", "unit", "value", "from", "to"],
    );
    for surface in surfaces {
        let found = [Some(surface.sliding), Some(surface.adhesion), surface.sticking];
        for f in found.iter().flatten() {
            let [name, unit, value, from, to] = show(f);
            t.row([surface.name().into(), name, unit, value, from, to]);
        }
    }
    s.table(t);
    let residuals: Vec<String> = surfaces
        .iter()
        .map(|surface| format!("{:.2} N on the {} pipe", surface.residual, surface.name()))
        .collect();
    s.text(format!(
        "`pipe_friction` is the least that slides. RMS residuals of the sliding pull: {}.",
        residuals.join(", ")
    ));
}

/// Friction of the simulated pipe, and its sticking share where that was measured: of the worse surface.
fn pipe(surfaces: &[Surface]) -> String {
    let worse = surfaces
        .iter()
        .min_by(|a, b| a.sliding.value.total_cmp(&b.sliding.value));
    let Some(surface) = worse else {
        return String::new();
    };
    let sliding = surface.sliding.value;
    let share = surface.sticking.map_or(1.0, |sticking| sticking.value / sliding);
    format!(
        "[world]\npipe_friction = {sliding:.3}\npipe_friction_static_share = {:.3}\n\n",
        share.clamp(1.0, 2.0)
    )
}

fn coefficients(fit: &Fit) -> Table {
    let mut t = Table::new(
        "Coefficients with their 95 % confidence interval",
        &["name", "unit", "value", "from", "to"],
    );
    for f in &fit.fitted {
        t.row(show(f));
    }
    if !fit.fitted.iter().any(|f| f.name == "C_P") {
        t.row([
            "C_P".into(),
            "".into(),
            num(fit.exponent, 2),
            num(f64::NAN, 0),
            num(f64::NAN, 0),
        ]);
    }
    t.row(show(&fit.gain.0));
    t
}

fn curves(s: &mut Section, points: &[Point], fit: &Fit) {
    let mut infills: Vec<f64> = points.iter().map(|p| p.infill).collect();
    infills.sort_by(f64::total_cmp);
    infills.dedup_by(|a, b| (*a - *b).abs() < 0.05);
    let top = points.iter().map(|p| p.thrust).fold(0.0, f64::max);
    let (mut fits, mut rests) = (vec![], vec![]);
    for (i, rho) in infills.iter().take(8).enumerate() {
        let own = || points.iter().filter(move |p| (p.infill - rho).abs() < 0.05);
        let line = (0..=80)
            .map(|j| top * f64::from(j) / 80.0)
            .map(|x| (x, fit.tilt(*rho, x, 1.0)))
            .collect();
        fits.push(Series::new(
            format!("ρ {rho} %, fit at full power"),
            i,
            SeriesStyle::Line,
            line,
        ));
        let full = own()
            .filter(|p| p.power >= 0.95)
            .map(|p| (p.thrust, p.tilt))
            .collect();
        fits.push(Series::new("", i, SeriesStyle::Dots, full));
        let rest = own()
            .map(|p| (p.thrust, p.tilt - fit.tilt(p.infill, p.thrust, p.power)))
            .collect();
        rests.push(Series::new(format!("ρ {rho} %"), i, SeriesStyle::Dots, rest));
    }
    let x = || Axis::new("thrust (N)").with(&[0.0]);
    s.figure(
        "Left: the fit and the points at full power. Right: what the fit leaves of all points; a trend there means that Eq. 1 \
         has the wrong shape for this arm.",
        vec![
            Chart { title: "Tilt".to_owned(), x: x(), y: Axis::new("α (°)"), series: fits, ..Chart::default() },
            Chart {
                title: "Residuals".to_owned(),
                x: x(),
                y: Axis::new("measured less fitted (°)").with(&[0.0]),
                series: rests,
                ..Chart::default()
            },
        ],
    );
}

/// Console lines that set the parameters in `text`.
pub fn console_lines(text: &str) -> String {
    let named = text.lines().skip_while(|l| *l != "[params]").skip(1);
    let mut lines: String = named
        .filter_map(|l| l.split_once(" = "))
        .map(|(name, value)| format!("set {name} {value}\n"))
        .collect();
    lines += "save\n";
    lines
}

/// Parameter file: a scenario with this arm in `[vehicle]` and `[params]`.
///
/// # Errors
/// One line: a number outside the stack's range, and the range.
pub fn parameters(
    points: &[Point],
    fit: &Fit,
    tendon: Option<&TendonFit>,
    surfaces: &[Surface],
    source: &str,
) -> Result<String, String> {
    let rho = infill(points);
    let (a, b) = fit.at(rho);
    let top = f64::from(Params::default().thrust_max);
    if a <= 0.0 {
        return Err(format!(
            "the fitted arm does not rise with thrust: A = {a:.3} deg/N at {rho} %, allowed above 0"
        ));
    }
    let share = fit.level_thrust(rho).map_or(f64::NAN, |t| t / top);
    if !(-0.5..=1.0).contains(&share) {
        return Err(format!(
            "the fitted arm of {rho} % is never level in flight: α0 = {:.1} deg, A = {a:.3} deg/N, B = {b:.4} deg/N2; allowed \
             is a level thrust of -0.5 to 1 times {top} N",
            fit.offset
        ));
    }
    in_range(points, fit)?;
    // One infill's arm is independent of the infill, which is clamped to the stack's range.
    let [a1, a2, b1, b2] = fit.coefficients;
    let rho = rho.clamp(4.0, 10.0);
    let mut text = format!(
        "# Arm of {source}, fitted by sophie fit-arm: {} points, residual {:.3} deg RMS.\n\
         # sophie fly THIS_FILE flies the default mission with it. [vehicle] is what the simulator builds, [params] what the\n\
         # flight stack assumes, under the names of its parameter table.\n\n\
         [vehicle]\ninfill = {rho}\ngain_k = 1.0\narm_coefficients = [{a1:.6}, {a2:.6}, {b1:.6}, {b2:.6}]\n\
         arm_level_share = {share:.6}\n\n\
         {}[params]\ninfill = {rho}\ngain_k = 1.0\narm_a1 = {a1:.6}\narm_a2 = {a2:.6}\narm_b1 = {b1:.6}\narm_b2 = {b2:.6}\n\
         arm_level_share = {share:.6}\npower_exponent = {:.4}\n",
        points.len(),
        fit.residual,
        pipe(surfaces),
        fit.exponent.clamp(1.0, 2.5)
    );
    if let Some(friction) = friction::parameter(surfaces)? {
        text += &format!("pipe_friction = {:.3}\n", friction.value);
    }
    if let Some(TendonFit {
        lever, bend, relief, ..
    }) = tendon
    {
        text += &format!(
            "tendon_lever = {lever:.6}\ntendon_bend = {:.4}\ntendon_relief = {:.4}\n",
            bend[0].value, relief[0].value
        );
    }
    Scenario::parse(&text, "arm.toml", &Default::default()).map_err(|e| {
        let hint = unit_hint(points);
        format!("the fitted arm is out of range{hint}; as arm.toml, which is not written: {e}")
    })?;
    Ok(text)
}

fn unit_hint(points: &[Point]) -> String {
    reach(points).map_or_else(String::new, |(most, _)| {
        format!(": thrust_n ends at {most:.2} N, as thrusts in kgf do (1 kgf is 9.81 N)")
    })
}

fn in_range(points: &[Point], fit: &Fit) -> Result<(), String> {
    let one = fit.coefficients[1] == 0.0 && fit.coefficients[3] == 0.0;
    let names = if one {
        ["A", "", "B", ""]
    } else {
        ["A1", "A2", "B1", "B2"]
    };
    for ((name, value), key) in names
        .into_iter()
        .zip(fit.coefficients)
        .zip(["arm_a1", "arm_a2", "arm_b1", "arm_b2"])
    {
        let Some(row) = Params::TABLE.iter().find(|row| row.name == key) else {
            continue;
        };
        if (f64::from(row.min)..=f64::from(row.max)).contains(&value) {
            continue;
        }
        let unit = row.unit;
        let hint = unit_hint(points);
        return Err(format!(
            "the fitted arm is out of range: {name} = {value:.4} {unit}, allowed {} to {} {unit}{hint}",
            row.min, row.max
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::fit_report::*;
    use sophie_fit::arm::fit;

    #[test]
    fn the_file_is_an_arm_that_simulator_and_stack_agree_on() {
        let points: Vec<Point> = (0..20)
            .map(|i| {
                let thrust = 0.4 * f64::from(i);
                Point {
                    infill: 15.0,
                    thrust,
                    tilt: -9.0 + 4.0 * thrust - 0.2 * thrust * thrust,
                    power: 1.0,
                }
            })
            .collect();
        let f = fit(&points, [2.4387, -0.1997, -0.162, 0.0151]).unwrap();
        let text = parameters(&points, &f, None, &[], "bench.csv").unwrap();
        let s = Scenario::parse(&text, "arm.toml", &Default::default()).unwrap();
        let model = sophie_control::allocation::arm_deflection::ArmModel::from_params(&s.params);
        for t in [0.5f32, 3.0, 6.0] {
            let truth = -9.0 + 4.0 * t - 0.2 * t * t;
            assert!((model.angle(t).to_degrees() - truth).abs() < 0.01, "{t}");
        }
        assert!((s.vehicle.arm_coefficients[0] - 4.0).abs() < 1e-4);
        let lines = console_lines(&text);
        let mut board = Params::default();
        for line in lines.lines().filter(|l| *l != "save") {
            let [_, name, value] = line.split(' ').collect::<Vec<_>>()[..] else {
                panic!("{line}");
            };
            board.set(name, value.parse().unwrap()).unwrap();
        }
        for name in [
            "infill",
            "gain_k",
            "arm_a1",
            "arm_a2",
            "arm_b1",
            "arm_b2",
            "arm_level_share",
            "power_exponent",
        ] {
            assert!(board.get(name) == s.params.get(name), "{name}");
        }
        assert!(lines.ends_with("save\n"));
        let falling: Vec<Point> = points.iter().map(|p| Point { tilt: -p.tilt, ..*p }).collect();
        let f = fit(&falling, [2.4387, -0.1997, -0.162, 0.0151]).unwrap();
        assert!(
            parameters(&falling, &f, None, &[], "b")
                .unwrap_err()
                .contains("does not rise")
        );
    }
}
