//! Output of a command: running text on a [`console`], text [tables](table), and files in an [output directory](output).

pub mod console;
pub mod output;
pub mod table;

/// Longest complaint, characters: more than a path and a list of allowed values take, less than a file's line may have.
const COMPLAINT_MAX: usize = 8_000;

/// One line on stderr, cut after 8,000 characters; a closed stderr is ignored.
pub fn complain(program: &str, line: &str) {
    use std::io::Write;
    let line = console::one_line(line);
    let (shown, end) = match line.char_indices().nth(COMPLAINT_MAX) {
        Some((at, _)) => (line.get(..at).unwrap_or_default(), "…"),
        None => (line.as_str(), ""),
    };
    let _ = writeln!(std::io::stderr(), "{program}: {shown}{end}");
}
