//! Tables between two markers in a page of docs/, printed by a test.

use std::fs;
use std::path::Path;

/// Requires `table` between the markers of `part` in `docs/{name}.md`, or writes it if `WRITE_DOCS` is set; `test`
/// writes it.
///
/// # Panics
/// If markers are missing or the table differs.
pub fn holds(name: &str, part: &str, table: &str, test: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("docs/{name}.md"));
    let page = fs::read_to_string(&path).unwrap();
    let (begin, end) = (
        format!("<!-- {part}: begin -->\n"),
        format!("<!-- {part}: end -->"),
    );
    let from = page.find(&begin).unwrap() + begin.len();
    let to = from + page[from..].find(&end).unwrap();
    if std::env::var_os("WRITE_DOCS").is_some() {
        fs::write(&path, format!("{}{table}{}", &page[..from], &page[to..])).unwrap();
    } else {
        assert_eq!(
            &page[from..to],
            table,
            "docs/{name}.md is old: WRITE_DOCS=1 cargo test --test {test}"
        );
    }
}
