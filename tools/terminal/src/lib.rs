//! Output of a command: running text on a [`console`], text [tables](table), and files in an [output directory](output).

pub mod console;
pub mod output;
pub mod table;

/// One line on stderr; a closed stderr is ignored.
pub fn complain(program: &str, line: &str) {
    use std::io::Write;
    let _ = writeln!(std::io::stderr(), "{program}: {}", console::one_line(line));
}
