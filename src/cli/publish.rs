//! Results of a study: tables on the terminal, a page and JSON on disk, and JSON on stdout on request.

use std::time::Instant;

use sophie_research::results::model::Section;
use sophie_research::results::{page, text};
use sophie_terminal::console::{self, Console};
use sophie_terminal::output::OutDir;

/// Destination of the results.
pub struct Publisher {
    out: OutDir,
    console: Console,
    json: bool,
    started: Instant,
    files: [&'static str; 2],
}

impl Publisher {
    /// Writes results to `files`, page and JSON, in `dir`; `json`: also to stdout.
    ///
    /// # Errors
    /// One line: the directory cannot be written.
    pub fn new(dir: &std::path::Path, files: [&'static str; 2], json: bool) -> Result<Self, String> {
        Ok(Self {
            out: OutDir::prepare(dir, &files)?,
            console: Console::new(json),
            json,
            started: Instant::now(),
            files,
        })
    }

    /// A line on the terminal.
    pub fn say(&self, line: &str) {
        self.console.say(line);
    }

    /// The tables of section `number`, from 1, on the terminal.
    pub fn show(&self, number: usize, section: &Section) {
        for line in text::lines(number, section) {
            self.console.say(&line);
        }
    }

    /// Writes all results, and prints their places. `results` is JSON text.
    ///
    /// # Errors
    /// One line: a file or stdout cannot be written.
    pub fn write(self, title: &str, lead: &str, sections: &[Section], results: String) -> Result<(), String> {
        let page = page::html(title, lead, sections).into_bytes();
        let printed = self.json.then(|| results.clone());
        let files = self.files.into_iter().zip([page, results.into_bytes()]);
        let written = self.out.write(&files.collect::<Vec<_>>())?;
        self.console.say("");
        self.console.say(&format!(
            "{:.1} s, written: {}",
            self.started.elapsed().as_secs_f64(),
            written.join("  ")
        ));
        if let Some(results) = printed {
            console::print(results.trim_end())?;
        }
        self.console.end()
    }
}
