//! The tables of docs/mavlink.md.

use std::fs;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// One table is written after the other.
static PAGE: Mutex<()> = Mutex::new(());

/// Holds the table between the marks called `name` equal to `table`; writes it where `WRITE_DOCS` is set.
pub fn hold(name: &str, table: &str) {
    let _one = PAGE.lock().unwrap_or_else(PoisonError::into_inner);
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/mavlink.md");
    let text = fs::read_to_string(&page).unwrap();
    let [begin, end] = ["begin", "end"].map(|side| format!("<!-- {name}: {side} -->"));
    let (before, rest) = text.split_once(&begin).unwrap();
    let (kept, after) = rest.split_once(&end).unwrap();
    let table = format!("\n{table}");
    if std::env::var_os("WRITE_DOCS").is_some() {
        fs::write(&page, format!("{before}{begin}{table}{end}{after}")).unwrap();
    } else {
        assert!(kept == table, "run it with WRITE_DOCS=1");
    }
}
