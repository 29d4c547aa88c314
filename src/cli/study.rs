//! `sophie paper` and `sophie fit-arm`: results on terminal and disk.

use sophie_terminal::complain;
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

use super::PROGRAM;
use super::args::{FitArgs, PaperArgs};
use super::publish::Publisher;
use sophie_fit::arm::{self, Fit};
use sophie_fit::friction::{self, Surface};
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
