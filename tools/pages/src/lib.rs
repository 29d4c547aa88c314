//! Parts of the handbook that tests print from the code: `<!-- part: begin -->` to `<!-- part: end -->` in a page of docs/.

use std::path::PathBuf;
use std::{env, fs};

/// Set in the environment, it has the tests write the pages instead of comparing them.
const WRITE: &str = "WRITE_DOCS";

/// `docs/{name}` is `text`, or becomes it when `WRITE_DOCS` is set; `test` are the arguments of `cargo test` that run
/// the test.
///
/// # Panics
/// If the page is another, or cannot be written.
pub fn is(name: &str, text: &str, test: &str) {
    let path = page(name);
    if env::var_os(WRITE).is_some() {
        fs::write(&path, text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        return;
    }
    assert!(
        fs::read_to_string(&path).unwrap_or_default() == text,
        "docs/{name} is not what the code prints: {WRITE}=1 cargo test {test}"
    );
}

/// `docs/{name}.md` has each text between the markers of its part, or gets it when `WRITE_DOCS` is set.
///
/// # Panics
/// If the page lacks a marker, or has another text.
pub fn hold(name: &str, parts: &[(&str, String)], test: &str) {
    let path = page(&format!("{name}.md"));
    let found = fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let printed = parts.iter().fold(found, |page, (part, text)| {
        replaced(&page, part, text)
            .unwrap_or_else(|| panic!("docs/{name}.md: no `<!-- {part}: begin -->` with its end"))
    });
    is(&format!("{name}.md"), &printed, test);
}

fn page(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("../../docs/{name}"))
}

/// `page` with `text` between the markers of `part`, or `None` without them.
fn replaced(page: &str, part: &str, text: &str) -> Option<String> {
    let begin = format!("<!-- {part}: begin -->\n");
    let end = format!("<!-- {part}: end -->");
    let (before, rest) = page.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    Some(format!("{before}{begin}\n{}\n\n{end}{after}", text.trim_end()))
}

#[cfg(test)]
mod tests {
    use super::replaced;

    const PAGE: &str =
        "# A\n<!-- a: begin -->\nold\n<!-- a: end -->\n<!-- b: begin -->\nkept\n<!-- b: end -->\n";

    #[test]
    fn a_part_is_replaced_and_the_rest_stays() {
        let wanted = PAGE.replace("\nold\n", "\n\nnew\n\n");
        assert_eq!(replaced(PAGE, "a", "new"), Some(wanted));
    }

    #[test]
    fn what_is_printed_again_is_the_same() {
        let once = replaced(PAGE, "b", "| x |\n").unwrap();
        assert_eq!(replaced(&once, "b", "| x |\n"), Some(once));
    }

    #[test]
    fn a_part_without_both_markers_is_none() {
        assert_eq!(replaced(PAGE, "c", ""), None);
        assert_eq!(replaced("<!-- a: begin -->\n", "a", ""), None);
    }
}
