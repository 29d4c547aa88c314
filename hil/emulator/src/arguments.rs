//! Arguments of the binaries, with complaints of one line.

use std::process::ExitCode;

use clap::Parser;
use clap::error::ErrorKind;
use sophie_report::terminal::complain;

/// The arguments of `program`.
///
/// # Errors
/// The exit status after help, the version or a complaint.
pub fn parse<A: Parser>(program: &str) -> Result<A, ExitCode> {
    A::try_parse().map_err(|error| {
        if matches!(error.kind(), ErrorKind::DisplayHelp | ErrorKind::DisplayVersion) {
            let _ = error.print();
            return ExitCode::SUCCESS;
        }
        let text = error.render().to_string();
        // The error precedes the first empty line.
        let lines: Vec<&str> = text
            .lines()
            .map(str::trim)
            .take_while(|l| !l.is_empty())
            .collect();
        complain(program, lines.join(" ").trim_start_matches("error: "));
        ExitCode::from(2)
    })
}
