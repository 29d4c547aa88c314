//! `sophie paper`, `sophie fit-arm` and `sophie fit-tendon`: results on terminal and disk.

use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

use super::PROGRAM;
use super::args::{FitArgs, FitTendonArgs, PaperArgs};
use super::publish::Publisher;
use sophie_control::gripper::tendon::REFERENCE_TILT;
use sophie_control::params::Params;
use sophie_fit::arm::{self, Fit};
use sophie_fit::friction::{self, Surface};
use sophie_fit::servo_steps::bench::Given;
use sophie_fit::servo_steps::{self, data};
use sophie_fit::tendon::{self, TendonFit};
use sophie_fit::{arm_data, friction_data, tendon_data};
use sophie_research::fit_report as report;
use sophie_research::paper;
use sophie_research::paper::printed::Printed;
use sophie_research::results::{json, page, text};

const FIT_FILES: [&str; 4] = ["fit.html", "fit.json", "arm.toml", "arm.console"];

/// Computes and writes every section.
pub fn paper(args: &PaperArgs) -> Result<bool, String> {
    let publisher = Publisher::new(&args.out, ["paper.html", "paper.json"], args.json)?;
    let printed = Printed::read();
    let mut sections = vec![];
    for work in paper::SECTIONS {
        let section = work(&printed);
        publisher.show(sections.len() + 1, &section);
        sections.push(section);
    }
    let results = json::json(&sections);
    publisher.write(paper::TITLE, paper::LEAD, &sections, results)?;
    Ok(true)
}

/// Fits an arm to bench data.
pub fn fit_arm(args: &FitArgs) -> Result<bool, String> {
    // The files of parameters name it in a comment.
    let file = console::one_line(&args.bench.display().to_string());
    let points = arm_data::load(&args.bench)?;
    let t = Printed::read().table_1;
    let fitted = arm::fit(&points, [t.a1, t.a2, t.b1, t.b2]).map_err(|why| format!("{file}: {why}"))?;
    report::check_units(&points).map_err(|why| format!("{file}: {why}"))?;
    let tendon = fit_tendon(args, &fitted, report::infill(&points))?;
    let surfaces = fit_friction(args)?;
    let parameters = report::parameters(&points, &fitted, tendon.as_ref(), &surfaces, &file)
        .map_err(|why| format!("{file}: {why}"))?;
    let out = OutDir::prepare(&args.out, &FIT_FILES)?;
    let console = Console::new(args.json);
    let sections = [report::section(&points, &fitted, tendon.as_ref(), &surfaces)];
    for line in text::lines(1, &sections[0]) {
        console.say(&line);
    }
    let results = json::json(&sections);
    let page = page::html("An arm from bench data", &file, &sections);
    let lines = report::console_lines(&parameters);
    let files = [
        page.into_bytes(),
        results.clone().into_bytes(),
        parameters.into_bytes(),
        lines.into_bytes(),
    ];
    let written = out.write(&FIT_FILES.into_iter().zip(files).collect::<Vec<_>>())?;
    console.say("");
    console.say(&format!("written: {}", written.join("  ")));
    for warning in report::warnings(&points, &fitted) {
        complain(PROGRAM, &format!("warning: {file}: {warning}"));
    }
    if args.json {
        console::print(results.trim_end())?;
    }
    console.end()?;
    Ok(true)
}

/// Fits a tendon to steps of its servo.
pub fn fit_tendon_steps(args: &FitTendonArgs) -> Result<bool, String> {
    let file = console::one_line(&args.steps.display().to_string());
    let p = Params::DEFAULT;
    let given = Given {
        reel_radius: 1e-3 * args.reel,
        lever: 1e-3 * args.lever,
        length: p.arm_d.into(),
        bend: p.tendon_bend.into(),
        reference: REFERENCE_TILT.into(),
        speed: p.servo_slew_1.into(),
    };
    let found =
        servo_steps::fit(&data::load(&args.steps)?, &given).map_err(|why| format!("{file}: {why}"))?;
    let console = Console::new(false);
    for line in found.lines() {
        console.say(&line);
    }
    console.say(&format!("set tendon_stiffness {:.0}", found.stiffness.value));
    let turn = found.slack.value / given.reel_radius;
    console.say(&format!(
        "servo_trim of this servo: {:+.1} deg of the reel, {:+.0} us where 270 deg are 1,900 us",
        turn.to_degrees(),
        turn.to_degrees() * 1900.0 / 270.0
    ));
    console.end()?;
    Ok(true)
}

/// Fits the tendon to the second table, if given.
fn fit_tendon(args: &FitArgs, arm: &Fit, infill: f64) -> Result<Option<TendonFit>, String> {
    let Some(path) = &args.tendon else {
        return Ok(None);
    };
    let rows = tendon_data::load(path)?;
    let fitted = tendon::fit(&rows, arm, 1e-3 * args.lever, infill);
    fitted
        .map(Some)
        .map_err(|why| format!("{}: {why}", path.display()))
}

/// Fits the friction to the third table; no surfaces without one.
fn fit_friction(args: &FitArgs) -> Result<Vec<Surface>, String> {
    let Some(path) = &args.friction else {
        return Ok(Vec::new());
    };
    let pulls = friction_data::load(path)?;
    let complaint = |why| format!("{}: {why}", path.display());
    let surfaces = friction::fit(&pulls).map_err(complaint)?;
    friction::parameter(&surfaces).map_err(complaint)?;
    Ok(surfaces)
}
