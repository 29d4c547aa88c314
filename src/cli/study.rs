//! `sophie paper`: the paper's results on the terminal and on disk.

use std::time::Instant;

use super::args::PaperArgs;
use super::console::{self, Console};
use super::output::OutDir;
use crate::paper::printed::Printed;
use crate::paper::{self, json, page, text};

/// The files of the paper's results.
const FILES: [&str; 2] = ["paper.html", "paper.json"];

/// Computes, flies, prints and writes every section.
pub fn paper(args: &PaperArgs) -> Result<bool, String> {
    let out = OutDir::prepare(&args.out, &FILES)?;
    let console = Console::new(args.json);
    let printed = Printed::read();
    let started = Instant::now();
    let mut sections = vec![];
    for work in paper::SECTIONS {
        let section = work(&printed);
        for line in text::lines(sections.len() + 1, &section) {
            console.say(&line);
        }
        sections.push(section);
    }
    let results = json::json(&sections);
    let page = page::html(paper::TITLE, paper::LEAD, &sections);
    let files = [page.into_bytes(), results.clone().into_bytes()];
    let written = out.write(&FILES.into_iter().zip(files).collect::<Vec<_>>())?;
    console.say("");
    console.say(&format!(
        "{} sections in {:.1} s, written: {}",
        sections.len(),
        started.elapsed().as_secs_f64(),
        written.join("  ")
    ));
    if args.json {
        console::print(results.trim_end())?;
    }
    console.end()?;
    Ok(true)
}
